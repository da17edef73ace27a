"""Stands in for the command ``fogreduce`` while a warm server runs: hands it over, waits for its end.

`start` puts this file, as a script, and a link to the real command into the server's folder, and the folder
first on the PATH.  It imports what is built in and no more, so that it starts in 10 ms.  Where the server
does not answer, or dies, the real command runs instead: outputs are written beside and renamed, so a second
attempt does no harm.
"""

import _signal  # type: ignore[import-not-found]
import _socket
import os
import sys

TYPE_CHECKING = False  # the module typing takes longer than all else here
if TYPE_CHECKING:
    from typing import NoReturn

HERE = sys.argv[0].rpartition("/")[0]
#: Name of the link to the real command.
REAL = "real"
PATIENCE_S = 120.0


def cold() -> "NoReturn":
    """The real command, in place of this process."""
    real = os.readlink(f"{HERE}/{REAL}")  # noqa: PTH115
    os.execv(real, [real, *sys.argv[1:]])


def request() -> bytes:
    """Arguments, folder, mask of file modes and environment, as `serve` reads them."""
    fields = [b"%d" % (len(sys.argv) - 1), *map(os.fsencode, sys.argv[1:])]
    mask = os.umask(0)
    os.umask(mask)
    fields += [os.getcwdb(), b"%d" % mask]  # noqa: PTH109
    fields += [name + b"=" + value for name, value in os.environb.items()]
    body = b"\0".join(fields)
    return len(body).to_bytes(8, "little") + body


def main() -> "NoReturn":
    """Run the command; ends with its exit status."""
    if "SLURM_JOB_ID" in os.environ:
        cold()  # the server may be another machine's, and is not in the job's account
    server = _socket.socket(_socket.AF_UNIX, _socket.SOCK_STREAM)
    try:
        server.settimeout(PATIENCE_S)
        server.connect(HERE + "/socket")
        body = request()
        streams = b"".join(number.to_bytes(4, sys.byteorder) for number in (0, 1, 2))
        sent = server.sendmsg([body], [(_socket.SOL_SOCKET, _socket.SCM_RIGHTS, streams)])
        server.sendall(body[sent:])
        for number in (_signal.SIGINT, _signal.SIGTERM, _signal.SIGHUP):
            _signal.signal(number, lambda *_: server.sendall(b"t"))  # the job tidies up, then we end
        if server.recv(1) != b"+":
            cold()
        server.settimeout(None)
        answer = server.recv(4)
    except OSError:
        answer = b""
    if len(answer) != 4:
        cold()
    status = int.from_bytes(answer, "little", signed=True)
    if status < 0:
        if -status != _signal.SIGKILL:
            _signal.signal(-status, _signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    os._exit(status)


if __name__ == "__main__":
    main()
