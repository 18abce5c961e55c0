# Within a clean Debian: installs /signorini.deb and uses what it brings, as tests/package/run does.
set -euo pipefail
apt-get update >/dev/null
apt-get install --yes --no-install-recommends /signorini.deb curl python3-minimal >/dev/null

signorinid --version
examples=/usr/share/doc/signorini/examples
signorinid solve --fields summary "$examples/elastic-block.json" > result.json
python3 -c 'import json; summary = json.load(open("result.json"))["summary"]; assert summary["error_bound"]["guaranteed"]'

signorinid --port 0 --data-dir /tmp/solves 2> log &
daemon=$!
trap 'kill $daemon' EXIT
url=
for _ in $(seq 100); do
  url=$(sed -n 's/.*listening on \(http[^ ]*\).*/\1/p' log)
  [ -n "$url" ] && break
  sleep 0.1
done
curl --silent --fail --header 'Content-Type: application/json' --data-binary @"$examples/paper-conforming.json" \
  "$url/v1/solves?wait=60&fields=summary" | grep --quiet '"status":"succeeded"'

for file in /usr/share/man/man1/signorinid.1.gz /usr/share/man/man1/signorinid-solve.1.gz \
  /lib/systemd/system/signorinid.service /usr/share/doc/signorini/copyright; do
  [ -s "$file" ] || [ -s "/usr$file" ] || { echo "$file is missing" >&2; exit 1; }
done
zcat /usr/share/man/man1/signorinid-solve.1.gz | grep --quiet -- '--fields\|fields'

# bash completes flags and their words.
source /usr/share/bash-completion/completions/signorinid
COMP_WORDS=(signorinid solve --format "") COMP_CWORD=3
_signorinid
[[ " ${COMPREPLY[*]} " == *" cbor "* ]]
COMP_WORDS=(signorinid --wor) COMP_CWORD=1
_signorinid
[[ ${COMPREPLY[0]} == --workers ]]
