// The page: its views, one at a time.
import { explain, setToken, catalog, type Explained } from "./base/api";
import { CatalogueView } from "./catalogue/catalogue_view";
import { CellView } from "./cells/cell_view";
import { h, replace } from "./base/dom";
import { GraspView } from "./grasps/grasp_view";
import { HealthView } from "./health_view";
import { LookAlikeView } from "./catalogue/look_alike_view";
import type { Scan } from "./files/scan";
import { SceneView } from "./scene/scene_view";
import { TeachPage } from "./teach/teach_page";

const banner = h("div", { className: "banner", role: "alert", hidden: true });
function report(error: Explained | undefined): void {
  banner.hidden = error === undefined;
  if (!error) return;
  replace(banner, h("p", {}, h("strong", {}, error.title), error.text !== "" && `: ${error.text}`),
    error.advice !== "" && h("p", {}, h("strong", {}, "Next step: "), error.advice),
    error.requestId !== "" && h("p", {}, h("small", {}, `request id ${error.requestId}, as in the server's log`)),
    error.needsToken && tokenForm(),
    h("button", { type: "button", className: "close", "aria-label": "Close", onclick: () => report(undefined) }, "×"));
}

function tokenForm(): HTMLElement {
  const input = h("input", { type: "password", autocomplete: "off", id: "token" });
  return h("form", {
    className: "token",
    onsubmit: (event: Event) => {
      event.preventDefault();
      setToken(input.value);
      report(undefined);
      open();
    },
  }, h("label", { for: "token" }, "Token (kept until the page is closed)"), input, h("button", { type: "submit" }, "Use it"));
}

const health = new HealthView(report);
const scene = new SceneView(report, (answer) => health.add(answer));
const openScan = (scan: Scan): void => {
  location.hash = "#scene";
  scene.use(scan);
};
const catalogue = new CatalogueView(report, openScan, (stablePose) => grasps.choose(stablePose), () => showRevision());
const grasps = new GraspView(report);
const teach = new TeachPage(report);
const lookAlikes = new LookAlikeView(report);
const cells = new CellView(report, openScan);
const views = { scene, catalogue, grasps, teach, lookAlikes, cells, health };
type Name = keyof typeof views;
const titles: Record<Name, string> = { scene: "Scene", catalogue: "Catalogue", grasps: "Grasps", teach: "Teach", lookAlikes: "Look-alikes", cells: "Cells", health: "Health" };

const main = h("main", {});
const links = (Object.keys(views) as Name[]).map((name) => h("a", { href: `#${name}` }, titles[name]));
const revision = h("span", { className: "revision" });

function current(): Name {
  const name = location.hash.slice(1);
  return name in views ? (name as Name) : "scene";
}

function showRevision(): void {
  catalog.getCatalogStatus({}).then(
    (status) => replace(revision, `server ${status.serverVersion} · revision ${status.catalogRevision}`),
    (error) => {
      replace(revision, "no server");
      report(explain(error));
    });
}

function open(): void {
  const name = current();
  document.title = `graspdb – ${titles[name]}`;
  for (const link of links) {
    if (link.hash === `#${name}`) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  if (main.firstChild !== views[name].element) replace(main, views[name].element);
  views[name].opened();
  showRevision();
}

document.body.append(
  h("header", {}, h("h1", {}, h("a", { href: "#scene", className: "brand" }, "graspdb")), h("nav", { "aria-label": "Views" }, links), revision),
  banner, main);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const view of [scene, catalogue, grasps, teach, lookAlikes, cells]) view.recolour();
});
addEventListener("hashchange", () => {
  report(undefined);
  open();
});
open();
