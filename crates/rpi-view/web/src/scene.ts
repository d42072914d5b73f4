// The cell in 3D: arms as capsules, the paths of the tools, and frames. z is up, lengths are in m.

import {
  AmbientLight,
  AxesHelper,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  Color,
  CylinderGeometry,
  DirectionalLight,
  GridHelper,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshLambertMaterial,
  Object3D,
  PerspectiveCamera,
  Quaternion,
  Scene,
  SphereGeometry,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { ArmHead, Flow, JointHead, Recording } from "./document";
import { type CommandColours, isDark, style } from "./palette";
import type { ViewState } from "./state";

/** Maximum number of points of the path of a tool. */
const PATH_POINTS = 20_000;
/** Time in s after which the path of a tool is drawn anew while a run goes on. */
const PATH_AGE = 1;
/** Length in m below which a link is shown without a capsule. */
const SHORTEST = 1e-3;
const JOINT_TOPIC = "joint.commanded_position";
const TOOL_TOPIC = "tcp.commanded_position.position";

/** Arm in the scene: a chain of objects, each in the frame of the one before. */
class ArmObject {
  readonly root = new Group();
  private readonly joints: { object: Group; joint: JointHead; at: Vector3; axis: Vector3; flow?: Flow }[] = [];
  private readonly links = new MeshLambertMaterial();
  private readonly housings = new MeshLambertMaterial();
  readonly tool = new Group();

  constructor(arm: ArmHead, recording: Recording) {
    place(this.root, arm.base);
    const radius = linkRadius(arm);
    const points = arm.joints.map((joint) => new Vector3(...joint.point));
    const flange = new Vector3(arm.flange[0], arm.flange[1], arm.flange[2]);
    let [parent, origin]: [Object3D, Vector3] = [this.root, new Vector3()];
    const cylinder = new CylinderGeometry(radius * 1.25, radius * 1.25, radius * 2.6, 24);
    if (points[0]) this.link(this.root, points[0], radius * 1.2);
    arm.joints.forEach((joint, k) => {
      const at = points[k]!.clone().sub(origin);
      const axis = new Vector3(...joint.direction);
      const object = new Group();
      object.position.copy(at);
      const housing = new Mesh(cylinder, this.housings);
      housing.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), axis);
      object.add(housing);
      this.link(object, (points[k + 1] ?? flange).clone().sub(points[k]!), radius);
      parent.add(object);
      this.joints.push({ object, joint, at, axis, flow: recording.flow(`/device/${arm.name}.${JOINT_TOPIC}[${k}]`) ?? recording.flow(`/device/${arm.name}.${JOINT_TOPIC}`) });
      [parent, origin] = [object, points[k]!];
    });
    const end = new Group();
    place(end, arm.flange);
    end.position.sub(origin);
    parent.add(end);
    place(this.tool, arm.tool);
    this.link(end, this.tool.position.clone(), radius * 0.5);
    this.tool.add(new AxesHelper(0.16), new Mesh(new SphereGeometry(0.012), this.housings));
    end.add(this.tool);
  }

  private link(parent: Object3D, to: Vector3, radius: number): void {
    const length = to.length();
    if (length < SHORTEST) return;
    const mesh = new Mesh(new CapsuleGeometry(radius, length, 6, 20), this.links);
    mesh.position.copy(to).multiplyScalar(0.5);
    mesh.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), to.clone().normalize());
    parent.add(mesh);
  }

  update(tick: number): void {
    for (const { object, joint, at, axis, flow } of this.joints) {
      const value = flow?.at(tick);
      if (value === undefined || !Number.isFinite(value)) continue;
      if (joint.prismatic) object.position.copy(axis).multiplyScalar(value).add(at);
      else object.quaternion.setFromAxisAngle(axis, value);
    }
  }

  theme(): void {
    this.links.color.set(isDark() ? 0xb8c2cc : 0xcfd6dd);
    this.housings.color.set(isDark() ? 0xe08a3c : 0xd9772b);
  }
}

/** Path of a tool, coloured by the command that drives the arm. */
class PathObject {
  readonly lines: Line[] = [];
  private readonly ticks: number[] = [];
  private readonly commands: string[] = [];
  private readonly done: BufferGeometry;
  private readonly colours: Float32Array;

  constructor(arm: ArmHead, state: ViewState) {
    const { recording } = state;
    const flows = ["x", "y", "z"].map((axis) => recording.flow(`/device/${arm.name}.${TOOL_TOPIC}.${axis}`));
    const base = new Object3D();
    place(base, arm.base);
    base.updateMatrix();
    const points: number[] = [];
    const step = Math.max(1, Math.ceil((recording.last + 1 - recording.first) / PATH_POINTS));
    const drives = recording.head.activity.filter((a) => a.path === "" && a.devices.includes(arm.name));
    const spans = drives.flatMap((a) => a.spans.map(([from, to]) => ({ from, to, command: a.command })));
    spans.sort((a, b) => a.from - b.from);
    let next = 0;
    for (let tick = recording.first; tick <= recording.last; tick += step) {
      const [x, y, z] = flows.map((flow) => flow?.at(tick));
      if (x === undefined || y === undefined || z === undefined) continue;
      const point = new Vector3(x, y, z).applyMatrix4(base.matrix);
      points.push(point.x, point.y, point.z);
      this.ticks.push(tick);
      while (next < spans.length && spans[next]!.to <= tick) next++;
      const span = spans[next];
      this.commands.push(span && span.from <= tick ? span.command : "");
    }
    const positions = new BufferAttribute(new Float32Array(points), 3);
    this.colours = new Float32Array(points.length);
    const colours = new BufferAttribute(this.colours, 3);
    const geometry = () => new BufferGeometry().setAttribute("position", positions).setAttribute("color", colours);
    this.done = geometry();
    const faint = new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.35 });
    this.lines.push(new Line(geometry(), faint), new Line(this.done, new LineBasicMaterial({ vertexColors: true })));
  }

  /** Removes the path from a scene. */
  dispose(scene: Scene): void {
    scene.remove(...this.lines);
    for (const line of this.lines) line.geometry.dispose();
  }

  /** Shows the part of the path up to a tick in full colour. */
  update(tick: number): void {
    let [low, high] = [0, this.ticks.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.ticks[middle]! <= tick) low = middle + 1;
      else high = middle;
    }
    this.done.setDrawRange(0, low);
  }

  theme(colours: CommandColours): void {
    const colour = new Color();
    this.commands.forEach((command, k) => {
      colour.set(command === "" ? style("--faint") : colours.of(command)).toArray(this.colours, 3 * k);
    });
    for (const line of this.lines) line.geometry.getAttribute("color").needsUpdate = true;
  }
}

/** Sets position and rotation of an object from a pose: x, y, z and a quaternion. */
function place(object: Object3D, pose: number[]): void {
  object.position.set(pose[0]!, pose[1]!, pose[2]!);
  object.quaternion.copy(new Quaternion(pose[3], pose[4], pose[5], pose[6]));
}

/** Returns a radius that suits the size of an arm: a fourteenth of its mean link. */
function linkRadius(arm: ArmHead): number {
  const reach = Math.hypot(arm.flange[0]!, arm.flange[1]!, arm.flange[2]!);
  return Math.min(0.12, Math.max(0.02, 0.04 * reach));
}

/** View of the cell in 3D. It is drawn when something has changed, not in every frame. */
export class CellView {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(45, 1, 0.01, 200);
  private readonly renderer: WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly arms: ArmObject[];
  private paths: PathObject[];
  private pathsEnd = 0;
  private floor?: GridHelper;
  private drawPending = false;

  /** Throws an error if the browser has no WebGL. */
  constructor(
    private readonly host: HTMLElement,
    private readonly state: ViewState,
    private readonly colours: CommandColours,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true });
    host.append(this.renderer.domElement);
    this.renderer.domElement.setAttribute("aria-hidden", "true");
    const { head } = state.recording;
    this.arms = head.arms.map((arm) => new ArmObject(arm, state.recording));
    this.paths = head.arms.map((arm) => new PathObject(arm, state));
    for (const object of [...this.arms.map((arm) => arm.root), ...this.paths.flatMap((path) => path.lines)]) this.scene.add(object);
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(2, -3, 5);
    this.scene.add(new AmbientLight(0xffffff, 1.6), sun, new AxesHelper(0.25));
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.requestDraw());
    this.lookAtAll();
    new ResizeObserver(() => this.resize()).observe(host);
    state.onTick(() => this.update());
    state.onTheme(() => this.theme());
    state.onGrow(() => this.grow());
    this.theme();
    this.update();
  }

  /** Draws the paths anew if a run has gone on by a second or more. */
  private grow(): void {
    const { head, last, tickSeconds } = this.state.recording;
    if ((last - this.pathsEnd) * tickSeconds < PATH_AGE) return;
    this.pathsEnd = last;
    for (const path of this.paths) path.dispose(this.scene);
    this.paths = head.arms.map((arm) => new PathObject(arm, this.state));
    for (const path of this.paths) {
      this.scene.add(...path.lines);
      path.theme(this.colours);
    }
    this.update();
  }

  /** Turns the camera about the cell, by angles in rad, and moves it by a factor of its distance: for the keyboard. */
  orbit(turn: number, tilt: number, factor: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const radius = offset.length() * factor;
    const azimuth = Math.atan2(offset.y, offset.x) + turn;
    const height = Math.asin(offset.z / offset.length()) + tilt;
    const elevation = Math.min(1.5, Math.max(-1.5, height));
    offset.set(Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation));
    this.camera.position.copy(this.controls.target).addScaledVector(offset, radius);
    this.controls.update();
    this.requestDraw();
  }

  lookAtAll(): void {
    const centre = new Vector3();
    let reach = 0.8;
    for (const arm of this.state.recording.head.arms) {
      centre.add(new Vector3(arm.base[0], arm.base[1], arm.base[2]));
      reach = Math.max(reach, Math.hypot(arm.flange[0]!, arm.flange[1]!, arm.flange[2]!));
    }
    centre.divideScalar(Math.max(1, this.arms.length));
    this.controls.target.copy(centre).add(new Vector3(0.2 * reach, 0, 0.35 * reach));
    const spread = Math.max(...this.state.recording.head.arms.map((a) => Math.hypot(a.base[0]! - centre.x, a.base[1]! - centre.y)), 0);
    this.camera.position.copy(this.controls.target).add(new Vector3(1.05, -1.0, 0.6).multiplyScalar(reach + 0.8 * spread));
    this.controls.update();
    this.requestDraw();
  }

  /** Positions of the tools in the cell in m, by the order of the arms. */
  toolPositions(): [number, number, number][] {
    this.scene.updateMatrixWorld();
    return this.arms.map((arm) => arm.tool.getWorldPosition(new Vector3()).toArray());
  }

  private update(): void {
    this.arms.forEach((arm) => arm.update(this.state.tick));
    this.paths.forEach((path) => path.update(this.state.tick));
    this.requestDraw();
  }

  private theme(): void {
    this.scene.background = new Color(style("--scene"));
    if (this.floor) this.scene.remove(this.floor);
    this.floor = new GridHelper(4, 16, style("--grid-strong"), style("--grid"));
    this.floor.rotation.x = Math.PI / 2;
    this.scene.add(this.floor);
    this.arms.forEach((arm) => arm.theme());
    this.paths.forEach((path) => path.theme(this.colours));
    this.requestDraw();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.requestDraw();
  }

  private requestDraw(): void {
    if (this.drawPending) return;
    this.drawPending = true;
    requestAnimationFrame(() => {
      this.drawPending = false;
      // The cell is not shown while the net is. It is drawn when it gets a size again.
      if (this.host.clientWidth > 0) this.renderer.render(this.scene, this.camera);
    });
  }
}
