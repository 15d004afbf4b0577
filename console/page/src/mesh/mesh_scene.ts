// What the view for teaching from a mesh draws: the mesh, its stable poses, and their views.
import { Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, HemisphereLight, Matrix4, Mesh, MeshLambertMaterial, Vector3, type Group } from "three";
import type { Grasp } from "../../gen/graspdb/v1/catalog_pb";
import { matrixOf } from "../base/geometry";
import { boxOf } from "../catalogue/stable_pose_points";
import { axesObject, cloudObject, gripperObject, handleObject, heightObject, linesObject, styleColor, type Pane } from "../base/viewer";
import { worldObjectOf, type MeshView } from "./mesh_views";
import type { MeshStablePose } from "./stable_poses";
import { boundsOf, type TriangleMesh } from "./triangle_mesh";

// A stable pose with what is taught of it. `mesh`: in the object's frame.
export interface Choice { pose: MeshStablePose; grasps: Grasp[]; mesh: TriangleMesh; isChosen: boolean }

const graspColor = "#f08a24";
export const percent = (share: number): string => `${(100 * share).toFixed(1)} %`;

function addLights(group: Group): void {
  const sun = new DirectionalLight("#ffffff", 2);
  sun.position.set(0.5, -1, 2);
  group.add(new HemisphereLight("#ffffff", "#8899aa", 1.5), sun);
}

function meshObject(mesh: TriangleMesh, color: string, at: Matrix4): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(mesh.vertices, 3));
  geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
  const out = new Mesh(geometry, new MeshLambertMaterial({ color: new Color(color), flatShading: true }));
  out.applyMatrix4(at);
  return out;
}

// As it is in its file, for a size that looks wrong.
export function drawMesh(pane: Pane, mesh: TriangleMesh): Box3 {
  addLights(pane.content);
  pane.content.add(meshObject(mesh, styleColor("--table"), new Matrix4()));
  return boundsOf(mesh);
}

// The stable poses in rows, the most probable one at the front on the left. Keys are their positions.
export function drawPoses(pane: Pane, choices: Choice[], selected: number): Box3 {
  addLights(pane.content);
  const sizes = choices.map((each) => boundsOf(each.mesh).getSize(new Vector3()));
  const spacing = 1.3 * sizes.reduce((most, each) => Math.max(most, each.x, each.y), 0);
  const columns = Math.ceil(Math.sqrt(choices.length));
  const all = new Box3();
  choices.forEach((choice, i) => {
    const box = boundsOf(choice.mesh);
    const middle = box.getCenter(new Vector3());
    const [x, y] = [(i % columns) * spacing, Math.floor(i / columns) * spacing];
    const at = new Matrix4().makeTranslation(x - middle.x, y - middle.y, 0);
    const color = !choice.isChosen ? "--table" : i === selected ? "--high" : "--low";
    const drawn = meshObject(choice.mesh, styleColor(color), at);
    drawn.userData.key = String(i);
    pane.content.add(drawn);
    const first = choice.isChosen ? choice.grasps[0] : undefined;
    if (first) pane.content.add(gripperObject(at.clone().multiply(matrixOf(first.tcpPose)), first.gripperOpeningM, 0, graspColor));
    pane.labels.push({
      at: new Vector3(x, y, box.max.z + 0.15 * spacing), text: `${choice.pose.id} · ${percent(choice.pose.probability)}`, key: String(i),
      tone: `${choice.isChosen ? "ok" : ""}${i === selected ? " selected" : ""}`,
    });
    all.union(box.applyMatrix4(at));
  });
  return all;
}

// The views of one stable pose in its frame, with the directions of the cameras. `selected`: -1: none. Keys are "view-0" and so on.
export function drawViews(pane: Pane, views: MeshView[], selected: number, grasps: Grasp[], worldSensor: Matrix4): Box3 {
  const box = boxOf(views.map((each) => each.points));
  const center = box.getCenter(new Vector3());
  const radius = 0.75 * Math.max(0.05, box.getSize(new Vector3()).length());
  views.forEach((each, i) => {
    const isOther = selected >= 0 && i !== selected;
    if (isOther) pane.content.add(cloudObject(each.points, styleColor("--table"), 1));
    else if (selected >= 0) pane.content.add(cloudObject(each.points, styleColor("--high"), 3));
    else pane.content.add(heightObject(each.points, box.min.z, box.max.z, 2));
    const direction = new Vector3().setFromMatrixPosition(worldObjectOf(each.turnDeg).invert().multiply(worldSensor)).sub(center).normalize();
    const [from, to] = [center.clone().addScaledVector(direction, radius), center.clone().addScaledVector(direction, 1.15 * radius)];
    const color = styleColor(isOther ? "--table" : "--high");
    pane.content.add(linesObject([...from.toArray(), ...to.toArray()], color), handleObject(to, `view-${i}`, color));
  });
  for (const grasp of grasps) pane.content.add(gripperObject(matrixOf(grasp.tcpPose), grasp.gripperOpeningM, grasp.approachDistanceM, graspColor));
  pane.content.add(axesObject(new Matrix4(), 0.03));
  return box.expandByScalar(0.25 * radius);
}
