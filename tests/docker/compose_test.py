#!/usr/bin/env python3
"""compose_test.py COMPOSE BIN: runs the services of a compose file that have images of ours, as processes.

Checks their commands and environments, not the images: each service has a loopback address in place of its
host name and of 0.0.0.0, and folders of a temporary directory in place of its volumes. The health check is the
Dockerfile's. Passes when each robot has picked once and, where Prometheus is installed, it has values for all panels of
the dashboards. Runs in a network namespace of its own.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "testing"))
import own_network  # noqa: E402
import prometheus  # noqa: E402

PROGRAMS = {"server": "graspdb-server", "cell": "graspdb-cell", "client": "graspdb"}
DATABASE = "/var/lib/graspdb"
TIMEOUT_S = 120


class Plant:
    def __init__(self, compose, programs, folder):
        self.programs, self.folder, self.running = programs, folder, {}
        self.services = {name: service for name, service in compose["services"].items() if "build" in service}
        self.addresses = {name: f"127.0.1.{i + 1}" for i, name in enumerate(self.services)}

    def replaced(self, name, text):
        text = text.replace("0.0.0.0:", self.addresses[name] + ":").replace("$$", "$")
        for volume in self.services[name].get("volumes", []):
            source, target = volume.split(":")[:2]
            (self.folder / source).mkdir(exist_ok=True)
            text = text.replace(target, str(self.folder / source))
        return re.sub(r"\b([a-z]+(?:-\d)?)(?=:\d{4,5}\b)", lambda at: self.addresses.get(at[1], at[1]), text)

    def start(self, name):
        service = self.services[name]
        environment = dict(service.get("environment", {}))
        if service["build"]["target"] == "server":  # The Dockerfile's.
            environment.update(GRASPDB_DB=DATABASE + "/db", GRASPDB_LISTEN="0.0.0.0:50051",
                               GRASPDB_ALLOW_REMOTE_WITHOUT_TLS="true")
        if service["build"]["target"] == "cell":
            environment["GRASPDB_HEALTH"] = "0.0.0.0:7102"  # The default is the same for all cells.
        environment = {key: self.replaced(name, value) for key, value in environment.items()}
        command = service.get("entrypoint", [PROGRAMS[service["build"]["target"]]]) + service.get("command", [])
        cwd = self.folder / f"tmp-{name}"
        cwd.mkdir()
        path = f"{self.programs}:{os.environ['PATH']}"
        with open(self.folder / f"{name}.log", "wb") as log:
            self.running[name] = subprocess.Popen(
                ["env", *(f"{key}={value}" for key, value in environment.items()), f"PATH={path}",
                 *(self.replaced(name, word) for word in command)], cwd=cwd, stdout=log, stderr=log)

    def log(self, name):
        return (self.folder / f"{name}.log").read_text(errors="replace")

    def is_ready(self, name, condition):
        if name not in self.running:
            return False
        status = self.running[name].poll()
        if condition == "service_completed_successfully":
            return status == 0
        if status is not None:
            raise SystemExit(f"{name} ended with {status}:\n{self.log(name)}")
        target = self.services[name]["build"]["target"]
        port = f"{self.addresses[name]}:{50051 if target == 'server' else 7102}"
        return subprocess.run([self.programs / PROGRAMS[target], "health", port], capture_output=True).returncode == 0

    def run(self):
        end = time.monotonic() + TIMEOUT_S
        while time.monotonic() < end:
            for name, service in self.services.items():
                needs = service.get("depends_on", {})
                if name not in self.running and all(self.is_ready(n, c["condition"]) for n, c in needs.items()):
                    self.start(name)
            robots = [name for name in self.services if name.startswith("robot")]
            if robots and all(name in self.running and "held" in self.log(name) for name in robots):
                return
            time.sleep(0.2)
        raise SystemExit("\n".join(f"{name}:\n{self.log(name)}" for name in self.running))


def monitor(plant, docker):
    """The Prometheus of the compose file with the dashboards and alerts of the product."""
    config = plant.replaced(next(iter(plant.services)), (docker / "prometheus.yml").read_text())
    monitor = prometheus.Prometheus(config, docker.parent / "monitoring", plant.folder)
    plant.running["prometheus"] = monitor.process
    print(f"Prometheus has values for all panels, and evaluates {monitor.check()} alerts")


def main():
    own_network.enter()
    with open(sys.argv[1], encoding="utf-8") as file:
        compose = yaml.safe_load(file)
    with tempfile.TemporaryDirectory() as folder:
        plant = Plant(compose, pathlib.Path(sys.argv[2]), pathlib.Path(folder))
        try:
            plant.run()
            if shutil.which("prometheus"):
                monitor(plant, pathlib.Path(sys.argv[1]).parent)
            for name in plant.services:
                print(name, "\n  ".join(plant.log(name).splitlines()[-2:]))
        finally:
            for process in plant.running.values():
                process.kill()


main()
