# Completes commands, flags and their words of signorinid in bash, from what --help says.
_signorinid() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} program=${COMP_WORDS[0]} command= i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case ${COMP_WORDS[i]} in solve | study | inf-sup | health | check) command=${COMP_WORDS[i]} ;; esac
  done
  local help flags words
  help=$("$program" $command --help 2>/dev/null) || return
  words=$(sed -n "s/^ *\(-.,\)\?$before TEXT:{\([^}]*\)}.*/\2/p" <<<"$help")
  flags=$(grep -oE -- '--[a-z][a-z-]+' <<<"$help")
  if [[ -n $words ]]; then
    COMPREPLY=($(compgen -W "${words//,/ }" -- "$word"))
  elif [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$flags" -- "$word"))
  elif [[ -z $command ]]; then
    COMPREPLY=($(compgen -W "solve study inf-sup health check" -- "$word"))
  else
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}
complete -o filenames -F _signorinid signorinid
