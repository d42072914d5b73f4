// Draws a net on a canvas: what lies in the visible part only, and texts only where they can be read.

import { style } from "../palette";
import type { NetBox, NetGraph } from "./graph";
import { HEAD, type NetLayout, PAD, type SceneLayout } from "./layout";
import type { NetValues } from "./values";

/** Scale below which boxes have no texts, below which they have no borders, and below which there are no lines. */
const TEXT_SCALE = 0.45;
const BORDER_SCALE = 0.2;
const LINE_SCALE = 0.1;
/** Maximum number of lines of a frame. Lines beyond are left out, which are too close together to be told apart. */
const MAX_LINES = 6000;

/** Place and size of the visible part: the point in the upper left corner, and pixels per unit. */
export interface Camera {
  x: number;
  y: number;
  scale: number;
}

const COLOURS = ["back", "panel", "text", "faint", "line", "grid-strong", "accent", "running", "lit", "lit-line", "on-colour"] as const;
type Colours = Record<(typeof COLOURS)[number], string>;

export class NetDrawing {
  private colours!: Colours;
  private context!: CanvasRenderingContext2D;
  private view = { left: 0, top: 0, right: 0, bottom: 0 };
  private lines = 0;
  /** Number of boxes of the last frame, for the tests. */
  drawn = 0;

  constructor(
    private readonly net: NetGraph,
    private readonly layout: NetLayout,
    private readonly values: NetValues,
  ) {
    this.theme();
  }

  theme(): void {
    this.colours = Object.fromEntries(COLOURS.map((name) => [name, style(`--${name}`)])) as Colours;
  }

  draw(canvas: HTMLCanvasElement, camera: Camera, selected: NetBox | undefined): void {
    const context = canvas.getContext("2d");
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!context || width === 0) return;
    this.context = context;
    const ratio = devicePixelRatio;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const scale = camera.scale * ratio;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.colours.back;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.setTransform(scale, 0, 0, scale, -camera.x * scale, -camera.y * scale);
    context.textBaseline = "middle";
    this.view = { left: camera.x, top: camera.y, right: camera.x + width / camera.scale, bottom: camera.y + height / camera.scale };
    this.lines = this.drawn = 0;
    const active = this.values.isActive(this.net, "") ?? true;
    this.scene(this.layout.root(), 0, [0, 0], { camera, selected, active });
  }

  private scene(layout: SceneLayout, scene: number, [x, y]: [number, number], shown: { camera: Camera; selected: NetBox | undefined; active: boolean }): void {
    const { view, net } = this;
    if (x > view.right || y > view.bottom || x + layout.width + 99 < view.left || y + layout.height + 99 < view.top) return;
    if (shown.camera.scale >= LINE_SCALE) this.drawLines(layout, scene, [x, y], shown);
    const boxes = net.boxes[scene]!;
    for (let k = 0; k < boxes.length; k++) {
      const [left, top] = [x + layout.x[k]!, y + layout.y[k]!];
      if (left > view.right || top > view.bottom || left + layout.w[k]! < view.left || top + layout.h[k]! < view.top) continue;
      const box = boxes[k]!;
      this.drawn++;
      const own = box.fragment === null ? undefined : this.values.isActive(net, box.fragment);
      const active = own ?? shown.active;
      const place = { left, top, width: layout.w[k]!, height: layout.h[k]! };
      const inner = layout.inner[k];
      this.box(box, place, { ...shown, active, isLit: own === true, isOpen: inner !== undefined });
      if (inner) this.scene(inner, box.inner, [left + PAD, top + HEAD], { ...shown, active });
    }
  }

  /** Draws the lines of a scene: first all, then those of the selected box. */
  private drawLines(layout: SceneLayout, scene: number, [x, y]: [number, number], { camera, selected }: { camera: Camera; selected: NetBox | undefined }): void {
    const { context, colours, view } = this;
    const heads = this.net.scenes[scene]!.lines;
    const [plain, delayed, marked] = [new Path2D(), new Path2D(), new Path2D()];
    const arrows = camera.scale >= TEXT_SCALE;
    for (let k = 0; k < heads.length && this.lines < MAX_LINES; k++) {
      const points = layout.lines[k]!;
      const [left, right] = [points[0]!, points[points.length - 2]!];
      if (x + Math.max(left, right) < view.left || x + Math.min(left, right) > view.right) continue;
      if (!layout.isBack[k] && !this.isVisible(points, y)) continue;
      this.lines++;
      const [from, , to, , bits] = heads[k]!;
      const isMarked = selected?.scene === scene && (selected.index === from || selected.index === to);
      const path = isMarked ? marked : bits !== 0 ? delayed : plain;
      trace(path, points, [x, y], layout.isBack[k]!);
      if (arrows) arrow(path, x + points[points.length - 2]!, y + points[points.length - 1]!);
    }
    const width = Math.max(1, 0.6 / camera.scale);
    const stroke = (path: Path2D, colour: string, factor: number, dash: number[] = []) => {
      context.strokeStyle = colour;
      context.lineWidth = width * factor;
      context.setLineDash(dash);
      context.stroke(path);
    };
    stroke(plain, colours["grid-strong"], 1.2);
    stroke(delayed, colours["grid-strong"], 1.2, [5, 4]);
    stroke(marked, colours.accent, 2);
    context.setLineDash([]);
  }

  private isVisible(points: Float64Array, y: number): boolean {
    let [low, high] = [Infinity, -Infinity];
    for (let k = 1; k < points.length; k += 2) {
      if (points[k]! < low) low = points[k]!;
      if (points[k]! > high) high = points[k]!;
    }
    return y + high >= this.view.top && y + low <= this.view.bottom;
  }

  private box(
    box: NetBox,
    { left, top, width, height }: { left: number; top: number; width: number; height: number },
    { camera, selected, active, isLit, isOpen }: { camera: Camera; selected: NetBox | undefined; active: boolean; isLit: boolean; isOpen: boolean },
  ): void {
    const { context, colours } = this;
    const isPort = box.kind === "in" || box.kind === "out";
    context.globalAlpha = active ? 1 : 0.55;
    if (camera.scale < BORDER_SCALE && !isOpen && box !== selected) {
      context.fillStyle = isLit ? colours["lit-line"] : colours["grid-strong"];
      context.fillRect(left, top, width, height);
      return;
    }
    context.beginPath();
    context.roundRect(left, top, width, height, isPort ? 9 : box.kind === "fragment" ? 3 : 6);
    context.fillStyle = isLit ? colours.lit : isPort ? colours.back : colours.panel;
    context.fill();
    context.lineWidth = Math.max(isLit || box === selected ? 2 : 1, 0.8 / camera.scale);
    context.strokeStyle = box === selected ? colours.accent : isLit ? colours["lit-line"] : colours["grid-strong"];
    context.setLineDash(box.fragment !== null && !active ? [5, 4] : []);
    context.stroke();
    context.setLineDash([]);
    if (box === selected) {
      context.lineWidth = 3;
      context.stroke();
    }
    if (camera.scale >= TEXT_SCALE) this.texts(box, { left, top, width }, { isOpen, isPort });
    context.globalAlpha = 1;
  }

  private texts(box: NetBox, { left, top, width }: { left: number; top: number; width: number }, { isOpen, isPort }: { isOpen: boolean; isPort: boolean }): void {
    const { context, colours } = this;
    const sign = box.inner < 0 ? "" : isOpen ? "▾ " : "▸ ";
    context.fillStyle = isPort ? colours.faint : colours.text;
    context.font = isPort ? "11px system-ui, sans-serif" : "600 12px system-ui, sans-serif";
    context.fillText(fitted(context, `${sign}${box.name}`, width - 12), left + 7, top + (isPort ? 10 : 13));
    if (isPort || isOpen) return;
    context.font = "11.5px ui-monospace, monospace";
    const count = box.inner < 0 ? 0 : this.net.boxes[box.inner]!.filter((inner) => inner.kind !== "in" && inner.kind !== "out").length;
    const text = this.values.text(this.net, box) ?? (count > 0 ? `${count} inside` : "");
    context.fillStyle = text === "absent" || count > 0 ? colours.faint : colours.text;
    context.fillText(fitted(context, text, width - 12), left + 7, top + 28);
  }
}

/** Traces a line: parts between columns as curves, which are horizontal at both ends, parts in a column as straight lines. */
function trace(path: Path2D, points: Float64Array, [x, y]: [number, number], isBack: boolean): void {
  path.moveTo(x + points[0]!, y + points[1]!);
  for (let k = 2; k < points.length; k += 2) {
    const [px, py, qx, qy] = [x + points[k - 2]!, y + points[k - 1]!, x + points[k]!, y + points[k + 1]!];
    if (isBack || py === qy) path.lineTo(qx, qy);
    else path.bezierCurveTo((px + qx) / 2, py, (px + qx) / 2, qy, qx, qy);
  }
}

function arrow(path: Path2D, x: number, y: number): void {
  path.moveTo(x - 6, y - 3.5);
  path.lineTo(x, y);
  path.lineTo(x - 6, y + 3.5);
}

const fits = new Map<string, string>();

/** Returns a text that is cut to a width. Widths are measured once for each text. */
function fitted(context: CanvasRenderingContext2D, text: string, width: number): string {
  // No letter of these fonts is wider than 12 pixels.
  if (text.length * 12 < width) return text;
  const key = `${context.font}|${Math.round(width)}|${text}`;
  const known = fits.get(key);
  if (known !== undefined) return known;
  let shown = text;
  while (shown.length > 2 && context.measureText(shown).width > width) shown = `${shown.slice(0, -2)}…`;
  if (fits.size > 20_000) fits.clear();
  fits.set(key, shown);
  return shown;
}
