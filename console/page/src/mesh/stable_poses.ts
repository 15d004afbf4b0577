// The stable poses of a mesh on a table, merged for a catalogue: as client/teaching/mesh/stable_poses.cc and cad_part.cc choose them.
import { Matrix4, Quaternion, Vector3 } from "three";
import { diameterOf, hullOf } from "./convex_hull";
import { centerOfMass, restingFacets, tipAngle, type MassCenter, type RestingFacet } from "./resting";
import { alike, findSymmetry, similarity, type FoundSymmetry } from "./shape_similarity";
import { movedCloud, surfaceOf, SurfaceModel } from "./surface_model";
import { boundsOf, transformed, type TriangleMesh } from "./triangle_mesh";

const degree = Math.PI / 180;
const rollLiftShare = 0.005;       // of the diameter
const contactShare = 0.002;        // of the diameter
const sameOrientation = 12 * degree;
const common = 0.05;               // an object rocks between two facets that are both so probable
const rocking = 1 * degree;
const nextFacet = 20 * degree;     // of an object that rolls
const sameLook = 0.0015;           // m
const minProbability = 0.01;       // as graspdb teach --min-probability
const stands = 5 * degree;         // as --stands
const maxFacets = 6000;

export interface MeshStablePose {
  id: string;           // resting-1 is the most probable one
  objectMesh: Matrix4;  // T_object_mesh: z up, on z = 0, the origin below the middle or on the axis of the symmetry
  probability: number;
  tipAngle: number;     // rad
  rolls: boolean;
  symmetry: FoundSymmetry;
  symmetryOrder: number;  // to declare: 1 where it is only nearly symmetric
}

export interface MeshStablePoses { poses: MeshStablePose[]; leftOut: number; mass: MassCenter }

// Neighbouring facets of one basin; `down` is that of the most probable one.
interface Orientation { down: Vector3; basin: number; probability: number; facetProbability: number; rolls: boolean }

const isRocking = (a: number, b: number): boolean => Math.min(a, b) >= common;

function orientationsOf(facets: RestingFacet[]): Orientation[] {
  const out: Orientation[] = [];
  const ofFacet: number[] = [];
  for (const facet of facets) {
    const same = out.findIndex((each) => each.basin === facet.basin &&
      each.down.dot(facet.down) > Math.cos(isRocking(each.facetProbability, facet.probability) ? rocking : sameOrientation));
    ofFacet.push(same < 0 ? out.length : same);
    if (same < 0) out.push({ down: facet.down, basin: facet.basin, probability: facet.probability, facetProbability: facet.probability, rolls: false });
    else out[same]!.probability += facet.probability;
  }
  // It rolls if the basin has a near facet of another orientation.
  facets.forEach((a, i) => {
    for (let j = 0; j < i; ++j) {
      const b = facets[j]!;
      if (ofFacet[i] === ofFacet[j] || a.basin !== b.basin || a.down.dot(b.down) < Math.cos(nextFacet) || isRocking(a.probability, b.probability)) continue;
      out[ofFacet[i]!]!.rolls = true;
      out[ofFacet[j]!]!.rolls = true;
    }
  });
  return out.sort((a, b) => b.probability - a.probability);
}

// T_object_mesh of a mesh that rests with `down`: the lowest point on z = 0, the middle of the bounding box on the z axis.
export function putDown(mesh: TriangleMesh, down: Vector3): Matrix4 {
  const pose = new Matrix4().makeRotationFromQuaternion(new Quaternion().setFromUnitVectors(down, new Vector3(0, 0, -1)));
  const box = boundsOf(transformed(mesh, pose));
  const middle = box.getCenter(new Vector3());
  return pose.setPosition(-middle.x, -middle.y, -box.min.z);
}

// Moves the origin to the symmetry axis, which passes through the centre of mass.
function onAxis(objectMesh: Matrix4, center: Vector3): Matrix4 {
  const at = center.clone().applyMatrix4(objectMesh);
  return new Matrix4().makeTranslation(-at.x, -at.y, 0).multiply(objectMesh);
}

interface Look { orientation: Orientation; model: SurfaceModel }

function looksOf(mesh: TriangleMesh, orientations: Orientation[], report: (text: string) => void): Look[] {
  const surface = surfaceOf(mesh);
  const out: Look[] = [];
  for (const [i, orientation] of orientations.entries()) {
    const model = new SurfaceModel(movedCloud(surface, putDown(mesh, orientation.down)));
    let same: Look | undefined;
    for (const look of out) {
      report(`orientation ${i + 1} of ${orientations.length}`);
      const limit = orientation.rolls && look.orientation.rolls ? alike(model) : sameLook;
      if (similarity(model, look.model) > limit) continue;
      same = look;
      break;
    }
    if (!same) out.push({ orientation: { ...orientation }, model });
    else {
      same.orientation.probability += orientation.probability;
      same.orientation.rolls ||= orientation.rolls;
    }
  }
  return out.sort((a, b) => b.orientation.probability - a.orientation.probability);
}

// Of a mesh in metres. Throws where it has no hull, or too many facets. `report`: before each step.
export function findStablePoses(mesh: TriangleMesh, report: (text: string) => void): MeshStablePoses {
  report("convex hull");
  const hull = hullOf(mesh);
  const mass = centerOfMass(mesh, hull);
  const diameter = diameterOf(hull);
  const facets = restingFacets(hull, mass.center, rollLiftShare * diameter);
  if (facets.length > maxFacets) throw new Error("the mesh is round in too fine steps; simplify it, or use graspdb teach OBJECT --mesh FILE");
  const out: MeshStablePoses = { poses: [], leftOut: 0, mass };
  for (const { orientation, model } of looksOf(mesh, orientationsOf(facets), report)) {
    const tips = tipAngle(hull, mass.center, orientation.down, contactShare * diameter);
    if (orientation.probability < minProbability && tips < stands && out.poses.length > 0) {
      out.leftOut += orientation.probability;
      continue;
    }
    report(`symmetry of pose ${out.poses.length + 1}`);
    const symmetry = findSymmetry(model);
    const symmetryOrder = symmetry.isNearly ? 1 : symmetry.order;
    const objectMesh = putDown(mesh, orientation.down);
    out.poses.push({
      id: `resting-${out.poses.length + 1}`, objectMesh: symmetryOrder === 1 ? objectMesh : onAxis(objectMesh, mass.center),
      probability: orientation.probability, tipAngle: tips, rolls: orientation.rolls, symmetry, symmetryOrder,
    });
  }
  return out;
}
