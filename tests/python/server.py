"""A graspdb-server on a free port, and a connection in between that can be cut."""
import os
import socket
import subprocess
import tempfile
import threading

BIN = os.environ["GRASPDB_BIN"]


class Server:
    """Runs in `with`; `address` is where it listens."""

    def __init__(self, folder, *flags, port=0):
        self._log = open(folder.path("server.log"), "ab")
        self._process = subprocess.Popen(
            [os.path.join(BIN, "graspdb-server"), "--db", folder.path("db"), "--listen", f"127.0.0.1:{port}",
             *flags], stdout=subprocess.PIPE, stderr=self._log, text=True)
        line = self._process.stdout.readline()
        if not line.startswith("listening on "):
            self.stop()
            with open(self._log.name, encoding="utf-8") as log:
                raise RuntimeError(log.read())
        self.address = line.split()[-1]

    def stop(self, kill=False):
        """As a service manager does, or as a crash. A client that makes no call keeps the former waiting for up to 10 s."""
        if kill:
            self._process.kill()
        else:
            self._process.terminate()
        self._process.wait()
        self._process.stdout.close()
        self._log.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()


class Folder(tempfile.TemporaryDirectory):
    """A folder that is removed at the end."""

    def __enter__(self):
        return self

    def path(self, *parts):
        return os.path.join(self.name, *parts)


class Relay:
    """Forwards connections to an address, in `with`; cut() ends those that are open, and with `for_good` refuses others."""

    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        self._to = (host, int(port))
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self._listener.getsockname()[1]
        self._ends = []
        self._lock = threading.Lock()
        self._threads = [threading.Thread(target=self._accept)]
        self._threads[0].start()

    def _accept(self):
        with self._listener:
            while True:
                try:
                    near = self._listener.accept()[0]
                except OSError:
                    return
                far = socket.create_connection(self._to)
                with self._lock:
                    self._ends += [near, far]
                    for ends in ((near, far), (far, near)):
                        self._threads.append(threading.Thread(target=self._forward, args=ends))
                        self._threads[-1].start()

    @staticmethod
    def _forward(source, target):
        try:
            while data := source.recv(65536):
                target.sendall(data)
        except OSError:
            pass
        for end in (source, target):
            end_connection(end)

    def cut(self, for_good=False):
        if for_good:
            end_connection(self._listener)
        with self._lock:
            for end in self._ends:
                end_connection(end)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.cut(for_good=True)
        self._threads[0].join()
        self.cut()  # what was accepted meanwhile
        for thread in self._threads[1:]:
            thread.join()
        for end in self._ends:
            end.close()


def end_connection(end):
    try:
        end.shutdown(socket.SHUT_RDWR)
    except OSError:
        pass  # has ended
