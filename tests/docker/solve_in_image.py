"""Runs the service in the root of an image as the user of the image, and solves the paper's example there.

    solve_in_image.py ROOT

Nothing of the root can be written, as with `docker run --read-only`; the volume is a file system in memory.
"""

import http.client
import json
import socket
import subprocess
import sys
import time

USER = 10001


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


PORT = free_port()
ENVIRONMENT = {
    "PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin",
    "SIGNORINI_HOST": "127.0.0.1",
    "SIGNORINI_PORT": str(PORT),
    "SIGNORINI_DATA_DIR": "/var/lib/signorini",
    "SIGNORINI_LOG_FORMAT": "json",
}

MOUNT_AND_RUN = f"""
set -e
root=$1; shift
mount --bind "$root" "$root"
mount --options remount,bind,ro "$root"
mount --rbind /proc "$root/proc"
mount --rbind /dev "$root/dev"
mount --types tmpfs --options uid={USER},mode=700 tmpfs "$root/var/lib/signorini"
exec chroot --userspec={USER}:{USER} "$root" "$@"
"""


def in_image(root, *command, **options):
    return subprocess.Popen(
        ["unshare", "--mount", "sh", "-c", MOUNT_AND_RUN, "sh", root, *command], env=ENVIRONMENT, text=True, **options)


def ask(method, path, body=None):
    connection = http.client.HTTPConnection("127.0.0.1", PORT, timeout=60)
    connection.request(method, path, body, {"Content-Type": "application/json"})
    reply = connection.getresponse()
    return reply.status, json.loads(reply.read())


def health(root):
    return in_image(root, "signorinid", "health", stderr=subprocess.DEVNULL).wait()


def main(root):
    assert in_image(root, "sh", "-c", "! touch /usr/here 2>/dev/null && touch /var/lib/signorini/here").wait() == 0
    assert health(root) == 1
    begin = time.time()
    service = in_image(root, "signorinid", stderr=subprocess.PIPE)
    try:
        while health(root) != 0:
            assert time.time() < begin + 30 and service.poll() is None, "it does not start"
        print(f"tests/docker: healthy after {time.time() - begin:.2f} s")
        status, problem = ask("GET", "/v1/examples/paper-nonconforming")
        status, result = ask("POST", "/v1/solves?wait=60&fields=summary", json.dumps(problem))
        assert status == 200 and result["summary"]["outcome"] == "converged", result
        assert result["summary"]["iterations"] == 103, result
    finally:
        service.terminate()
        log = service.communicate()[1]
    assert service.returncode == 0, log
    assert all("time" in json.loads(line) for line in log.splitlines()), log
    print(f"tests/docker: the paper's example is solved in {result['summary']['timings']['total']:.3f} s, "
          f"energy {result['summary']['energy']:.6f}")


if __name__ == "__main__":
    main(sys.argv[1])
