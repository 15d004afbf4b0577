"""Prometheus as a process: scrapes the plant of a compose file and answers the queries of the dashboards."""
import json
import pathlib
import re
import subprocess
import time
import urllib.error
import urllib.parse
import urllib.request

LISTEN = "127.0.1.250:9090"
TIMEOUT_S = 60
# Without data in a plant that has neither TLS nor unknown objects.
ABSENT = re.compile("graspdb_(certificate_end_time|unknown_objects)_")


def fetch(path, **parameters):
    url = f"http://{LISTEN}/api/v1/{path}?{urllib.parse.urlencode(parameters)}"
    try:
        with urllib.request.urlopen(url) as answer:
            return json.load(answer)["data"]
    except urllib.error.HTTPError as error:
        raise SystemExit(f"{parameters}: {error.read().decode()}") from error


class Prometheus:
    """`config` with other addresses scrapes every second, and reads the alerts beside it."""

    def __init__(self, config, monitoring, folder):
        self.monitoring = pathlib.Path(monitoring)
        alerts = (self.monitoring / "alerts.yml").read_text()
        (folder / "alerts.yml").write_text(alerts)
        (folder / "prometheus.yml").write_text(config.replace("scrape_interval: 15s", "scrape_interval: 1s"))
        self.log = folder / "prometheus.log"
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(
                ["prometheus", f"--config.file={folder}/prometheus.yml", f"--storage.tsdb.path={folder}/tsdb",
                 f"--web.listen-address={LISTEN}"], stdout=log, stderr=log)

    def without_data(self):
        """Queries of the dashboards, for all instances as Grafana selects them, that have no value."""
        out = []
        for path in sorted((self.monitoring / "dashboards").glob("*.json")):
            dashboard = json.loads(path.read_text())
            query = next(v for v in dashboard["templating"]["list"] if v["name"] == "instance")["query"]
            series, label = re.fullmatch(r"label_values\((.*), (\w+)\)", query).groups()
            values = sorted({re.escape(one["metric"][label]) for one in fetch("query", query=series)["result"]})
            instances = "|".join(values).replace("\\", "\\\\")
            for panel in dashboard["panels"]:
                for target in panel.get("targets", []):
                    expression = target["expr"].replace("$__interval", "1m").replace("$instance", instances)
                    if not fetch("query", query=expression)["result"] and not ABSENT.search(expression):
                        out.append(f"{path.name}: {panel['title']}: {expression}")
        return out

    def check(self):
        """Ends the program where a query fails, or has no value within a minute, or an alert cannot be evaluated."""
        end = time.monotonic() + TIMEOUT_S
        while True:
            try:
                empty = self.without_data()
                rules = [rule for group in fetch("rules")["groups"] for rule in group["rules"]]
                failed = [rule["name"] for rule in rules if rule["health"] != "ok"]
            except urllib.error.URLError as error:  # not yet started
                empty, failed, rules = [str(error.reason)], [], []
            if rules and not empty and not failed:
                return len(rules)
            if time.monotonic() > end or self.process.poll() is not None:
                raise SystemExit("\n".join(["Prometheus has no values for:", *empty, *failed, self.log.read_text()]))
            time.sleep(1)
