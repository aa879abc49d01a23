// The picture of the cell: the cylinder and the unwrapped map, drawn from the frames of the server.

import type { Defect, Frame, Inside, Outline, Palette } from '../protocol';
import { Control, type Tool } from './control';
import { Cylinder } from './cylinder';
import { Fields } from './fields';
import { FlatCylinder } from './flat';
import { UnwrappedMap } from './map';
import { CALM, PACE, Particles } from './particles';
import { place } from './place';
import { inSoftware, Quality } from './quality';
import { ScaleBar } from './scalebar';
import { surfaceOf, type Surface } from './surface';
import { Tracers } from './tracers';
import { OnScreen } from '../panels/onscreen';
import type { Units } from '../panels/units';
import { View, type Stance } from './view';
import { say } from '../words/say';

export type { Tool } from './control';

export interface SceneOptions {
  cylinder: HTMLElement;
  map: HTMLElement;
  palette: Palette;
  dark: boolean;
  /** Shows a sentence to the visitor. */
  notice(sentence: string): void;
}

/** Milliseconds between redraws of the map's colours, and of its streamlines. */
const MAP_EVERY = 60;
const LINES_EVERY = 330;
/** Most milliseconds to wait for an answer. */
const PATIENCE = 150;
/** Tracer particles; few for visitors who prefer less motion, and if the processor draws them. */
const MANY = 900;
const FEW = 300;
/** Tracers inside the opened cell, likewise, and few in a narrow picture. */
const MANY_INSIDE = 450;
const FEW_INSIDE = 250;
const NARROW = 420;


export class Scene {
  playing = false;
  onDrawn: ((frame: number) => void) | null = null;
  onStroke: ((points: [number, number][]) => void) | null = null;
  /** Called when the visitor has turned or enlarged the cell. */
  onView: (() => void) | null = null;

  private readonly canvas = document.createElement('canvas');
  private readonly fields = new Fields();
  private outline: Outline | null = null;
  private surface: Surface = surfaceOf(null, 5);
  private defects: Defect[] = [];
  private readonly view = new View();
  private readonly particles: Particles;
  private readonly tracers = new Tracers();
  private readonly map: UnwrappedMap;
  private readonly control: Control;
  private readonly quality = new Quality();
  private readonly bar = new ScaleBar();
  private readonly sight = new OnScreen(() => (this.stale = this.dirty = true));
  private cylinder: Cylinder | null = null;
  /** The cylinder as the processor paints it, once that was needed. */
  private painted: FlatCylinder | null = null;
  /** Says why a closed cell is not drawn without WebGL. */
  private readonly missing = Object.assign(document.createElement('p'), { className: 'note', hidden: true });
  private palette: Palette;
  private dark: boolean;
  private lost = false;
  private readonly software: boolean;
  private readonly calm: boolean;
  /** Nothing is drawn before this time, to make room for an answer; `owed` until something was drawn. */
  private waits = 0;
  private owed = false;

  private last = 0;
  private lastShown = -1;
  private confirmed = -1;
  /** How far the tracers were on their way when they were last drawn. */
  private drawnInside = 1;
  private mapped = { at: 0, version: -1, mixing: -1 };
  private linesAt = 0;
  /** Something other than the cell has changed: redraw the map, or everything. */
  private stale = true;
  private dirty = true;

  constructor(private readonly options: SceneOptions) {
    const { palette, dark } = options;
    this.palette = palette;
    this.dark = dark;
    const calm = (this.calm = matchMedia('(prefers-reduced-motion: reduce)').matches);
    const software = (this.software = inSoftware());
    this.particles = new Particles(calm, calm || software ? FEW : MANY);
    this.map = new UnwrappedMap(palette, this.particles);
    const label = (canvas: HTMLCanvasElement, text: string): void => {
      canvas.tabIndex = 0;
      canvas.setAttribute('role', 'application');
      canvas.setAttribute('aria-label', text);
    };
    label(this.canvas, say('scene.cylinder', { keys: say('scene.keys') }));
    label(this.map.moving, say('scene.map'));
    this.map.still.setAttribute('aria-hidden', 'true');
    place(options.cylinder, this.canvas);
    options.cylinder.append(this.bar.element);
    place(options.map, this.map.still, this.map.moving);
    this.canvas.style.touchAction = 'none';
    try {
      this.cylinder = new Cylinder(this.canvas, this.particles, this.tracers, palette, dark, software);
    } catch {
      this.missing.textContent = say('scene.no-webgl');
      options.cylinder.append(this.missing);
    }
    this.canvas.addEventListener('webglcontextlost', this.onLost);
    this.canvas.addEventListener('webglcontextrestored', this.onRestored);
    const changed = (): void => {
      this.dirty = true;
      this.onView?.();
    };
    this.control = new Control(this.canvas, this.map, this.view, this.fields, changed);
    this.control.onStroke = (points) => this.onStroke?.(points);
    const observer = new ResizeObserver(() => this.resize());
    observer.observe(options.cylinder);
    observer.observe(options.map);
    this.sight.watch(options.cylinder);
    this.sight.watch(options.map);
    // Where the processor draws, a picture has few pixels from the beginning.
    if (software && devicePixelRatio > 1) this.quality.lower();
    this.resize();
    requestAnimationFrame(this.loop);
  }

  get statistics(): { flat: boolean; frames: number; fps: number; lastShown: number; inside: number; tracers: number } {
    const { version, count } = this.tracers;
    const { frames, level } = this.quality;
    return { frames, flat: level.flat, fps: this.quality.fps(performance.now()), lastShown: this.lastShown, inside: version, tracers: count };
  }

  /** From where the cell is seen. */
  get stance(): Stance {
    const { turn, tilt, zoom, centre } = this.view;
    return { turn, tilt, zoom, centre };
  }

  set stance(stance: Stance) {
    Object.assign(this.view, stance);
    this.view.hold();
    this.dirty = true;
  }

  get opens(): boolean {
    return this.cylinder !== null;
  }

  /** What the page asks of the server for the inside. */
  get wanted(): { tracers: number; pace: number } {
    const few = this.calm || this.software || this.view.width < NARROW;
    return { tracers: few ? FEW_INSIDE : MANY_INSIDE, pace: this.calm ? CALM * PACE : PACE };
  }

  private label(): void {
    const { open } = this.view;
    const shape = this.outline ? 'scene.closed' : open ? 'scene.opened' : 'scene.cylinder';
    this.canvas.setAttribute('aria-label', say(shape, { keys: say('scene.keys') }));
  }

  /** Take the front of the cylinder away, or close it. */
  setOpen(open: boolean): void {
    this.view.open = open && this.opens && !this.outline;
    this.label();
    if (!open) this.tracers.clear();
    this.dirty = true;
  }

  /** The flow inside the cell of the last picture. */
  showInside(inside: Inside): void {
    if (!this.view.open || this.fields.empty || inside.length !== this.fields.length) return;
    this.tracers.take(inside, performance.now());
    this.dirty = true;
  }

  /**
   * A change of the cell was requested. If the processor does the drawing, drawing pauses until the answer arrives,
   * since it would compete with computing.
   */
  expect(): void {
    if (!this.software || this.owed) return;
    this.waits = performance.now() + PATIENCE;
    this.owed = true;
  }

  /** Show the next frame as soon as it arrives, without a transition: it answers an action. */
  hurry(): void {
    this.fields.hurried = true;
  }

  show(frame: Frame): void {
    const first = this.fields.empty;
    if (this.fields.hurried) this.waits = 0;
    if (first || frame.length !== this.surface.length) {
      const surface = (this.surface = surfaceOf(this.outline, frame.length));
      this.view.surface = surface;
      this.particles.scatter(surface);
      this.control.mark.z = Math.min(this.control.mark.z, 0.5 * frame.length);
      this.linesAt = 0;
      this.resize();
    }
    this.fields.take(frame, this.surface, performance.now());
    this.defects = frame.regime?.defects ?? [];
    this.dirty = true;
  }

  setPalette(palette: Palette): void {
    this.palette = palette;
    this.painted?.setPalette(palette);
    this.map.raster.setPalette(palette);
    this.map.zone = palette.zone;
    this.cylinder?.setPalette(palette);
    this.stale = this.dirty = true;
  }

  setDark(dark: boolean): void {
    this.dark = dark;
    this.map.restyle();
    this.painted?.setDark(dark);
    this.cylinder?.setDark(dark);
    this.stale = this.dirty = true;
  }

  /** Lengths are shown in these units. */
  setUnits(units: Units): void {
    this.map.units = units;
    this.bar.units = units;
    this.resize();
  }

  setTool(tool: Tool, radius: number): void {
    this.control.setTool(tool, radius);
  }

  /** Another cell will be shown, of this meridian if it is closed. */
  clear(outline: Outline | null): void {
    this.outline = outline;
    if (outline) this.view.open = false;
    this.defects = [];
    this.label();
    this.missing.hidden = this.cylinder !== null || !outline;
    this.fields.clear();
    this.lastShown = -1;
    this.tracers.clear();
    this.stale = this.dirty = true;
  }

  /** The canvases of cylinder and map, each to be laid over one another, drawn now: the browser keeps no WebGL picture. */
  canvases(everything: boolean): HTMLCanvasElement[][] {
    this.draw(performance.now(), everything);
    const map = [this.map.still, this.map.moving];
    const { flat } = this;
    if (flat) return [[flat.canvas], map];
    return this.cylinder && !this.lost ? [[this.canvas], map] : [map];
  }

  private readonly onLost = (event: Event): void => {
    event.preventDefault(); // otherwise it is never restored
    this.lost = true;
    this.options.notice(say('scene.lost'));
  };

  private readonly onRestored = (): void => {
    this.lost = false;
    this.dirty = true;
  };

  private resize(): void {
    const { cylinder, map } = this.options;
    this.view.width = Math.max(1, cylinder.clientWidth);
    this.view.height = Math.max(1, cylinder.clientHeight);
    this.view.hold();
    this.map.fit(map.clientWidth, map.clientHeight, this.surface, this.quality.ratio);
    this.stale = this.dirty = true;
  }

  private economise(): void {
    this.map.nth = this.quality.level.nth;
    this.resize();
  }

  /** The painter of the cylinder if the processor is to paint it; the picture of WebGL then does not show. */
  private get flat(): FlatCylinder | null {
    const wanted = !this.outline && !this.view.open && (this.quality.level.flat || !this.cylinder || this.lost);
    if (wanted && !this.painted) {
      this.painted = new FlatCylinder(this.palette, this.dark);
      this.painted.canvas.style.pointerEvents = 'none';
      this.painted.canvas.setAttribute('aria-hidden', 'true');
      place(this.options.cylinder, this.painted.canvas);
    }
    if (this.painted) this.painted.canvas.hidden = !wanted;
    this.canvas.style.opacity = wanted ? '0' : '';
    return wanted ? this.painted : null;
  }

  private readonly loop = (now: number): void => {
    requestAnimationFrame(this.loop);
    const since = now - this.last;
    const { fields } = this;
    if (now < this.waits) return;
    // Nothing is drawn without a change: a paused cell costs nothing.
    const moves = this.playing && !fields.empty;
    const passes =
      this.mapped.version !== fields.version || this.mapped.mixing < 1 || (this.view.open && this.drawnInside < 1);
    if (!moves && !this.dirty && !(passes && !fields.empty)) return;
    this.last = now;
    if (moves) this.particles.step(fields, Math.min(since, 100) / 1000);
    this.draw(now, false);
    if (this.quality.count(now, since)) this.economise();
    // Also a picture of the same frame, after an action, was sent and is confirmed.
    if (!fields.empty && fields.version !== this.confirmed) {
      this.confirmed = fields.version;
      this.lastShown = fields.frame;
      this.onDrawn?.(fields.frame);
    }
  };

  private draw(now: number, everything: boolean): void {
    const { fields, map, view, control, mapped } = this;
    this.dirty = this.owed = false;
    const mixing = fields.mixing(now);
    fields.blend(mixing);
    const changed = mapped.version !== fields.version || mapped.mixing !== mixing;
    const { sight, options } = this;
    const mapSeen = everything || sight.has(options.map);
    const again = everything || this.stale || (changed && now - mapped.at >= MAP_EVERY);
    if (again) {
      if (mapSeen) this.drawStill(now, mixing);
      this.mapped = { at: now, version: fields.version, mixing };
      this.stale = false;
    }
    const { flat } = this;
    const { ratio, level } = this.quality;
    this.bar.show(fields.empty || !(flat || this.cylinder) ? 0 : view.scale, view.width);
    if (mapSeen) map.drawMoving(fields, control.mark, view.turn, this.defects);
    this.drawnInside = this.tracers.empty ? 1 : this.tracers.mixing(now);
    if (!everything && !sight.has(options.cylinder)) return;
    if (flat && !fields.empty) {
      flat.draw(fields, mixing, view, ratio, again);
      flat.drawMoving(this.particles, level.nth, control.mark, fields, view, ratio);
    } else if (flat) flat.clear();
    else if (!this.lost) this.cylinder?.draw(now, fields, mixing, view, control.mark, this.defects, ratio);
  }

  private drawStill(now: number, mixing: number): void {
    const { map, fields } = this;
    if (now - this.linesAt >= LINES_EVERY) {
      map.layStreamlines(fields);
      this.linesAt = now;
    }
    map.drawStill(fields, mixing);
  }
}
