#!/usr/bin/env python3
"""run_blocks.py BIN SOURCE FILE: runs all ```sh blocks of a Markdown file as one bash script.

A block of another language with a name, as in ```python status.py, is written to the file of that name
first. Other blocks are not used. The script begins in an empty folder, which also takes the place of /tmp/cell
in the text, with the programs of BIN in PATH and SOURCE in GRASPDB; it ends at the first command that
fails, with that status. The network is a namespace of its own, where the kernel allows one: documents
name the default ports.
"""
import os
import re
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../testing"))
import own_network  # noqa: E402

def main():
    programs, source, document = (os.path.abspath(path) for path in sys.argv[1:4])
    own_network.enter()
    with open(document, encoding="utf-8") as file:
        text = file.read()
    blocks = re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    files = re.findall(r"^```[a-z]+ ([\w.]+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    if not blocks:
        sys.exit(f"{document} has no ```sh block")
    environment = dict(os.environ, GRASPDB=source, PATH=programs + ":" + os.environ["PATH"])
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files:
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(content)
        script = "set -euo pipefail\nset -x\n" + "\n".join(blocks).replace("/tmp/cell", folder)
        script = script.replace("$GRASPDB/build/release", os.path.dirname(programs))
        bash = subprocess.Popen(["bash", "-c", script], cwd=folder, env=environment,
                                stdin=subprocess.DEVNULL, start_new_session=True)
        status = bash.wait()
        try:
            os.killpg(bash.pid, signal.SIGKILL)  # what it left running
        except ProcessLookupError:
            pass
        if status:
            for name in sorted(os.listdir(folder)):
                if name.endswith(".log"):
                    with open(os.path.join(folder, name), encoding="utf-8", errors="replace") as log:
                        print(f"== {name}\n{log.read()[-4000:]}")
    sys.exit(status)


main()
