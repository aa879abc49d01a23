import type { Curves, Hub } from './hub';
import { h, panel } from './dom';
import { mathematics } from './mathematics';
import { borders, cellOf, mix, others } from './plane';
import { short } from './scales';
import { debounce } from './throttle';
import { said, say } from '../words/say';

const LEFT = 46, BELOW = 30, ABOVE = 6, RIGHT = 8, HEIGHT = 270;
const DASHES: number[][] = [[], [7, 4], [2, 3], [8, 3, 2, 3], [12, 4]];

/** The map of outcomes over both alignments: where this cell is, and a way to move it elsewhere. */
export function diagram(hub: Hub): HTMLElement {
  const { alpha_p, alpha_u, share, parameters, caption } = hub.about.diagram;
  const xs = borders(alpha_p), ys = borders(alpha_u);
  const xMost = xs.at(-1)!, yMost = ys.at(-1)!;
  const canvas = h('canvas', {
    id: 'diagram', tabindex: 0, role: 'application', 'aria-describedby': 'diagram-here diagram-caption',
    'aria-label': say('diagram.label'),
  });
  const here = h('p', { id: 'diagram-here', class: 'note', 'aria-live': 'polite' });
  const legend = h('ul', { class: 'legend' });
  const note = h('p', { id: 'diagram-caption', class: 'note' });
  const ends = h('p', { id: 'diagram-ends', class: 'note', hidden: true }, say('diagram.ends'));
  let curves: Curves | null = null;
  let cursor: [number, number] | null = null;
  let width = 340;

  const x = (value: number): number => LEFT + (value / xMost) * (width - LEFT - RIGHT);
  const y = (value: number): number => HEIGHT - BELOW - (value / yMost) * (HEIGHT - BELOW - ABOVE);
  const chance = (a: number, b: number): number => share[cellOf(xs, a)]![cellOf(ys, b)]!;
  const tell = (a: number, b: number, key: 'diagram.here' | 'diagram.go'): void => {
    const place = say(key, { a: short(a), b: short(b) });
    const covered = a <= xMost && b <= yMost && others(parameters, hub.parameters).length === 0;
    here.textContent = covered ? say('diagram.chance', { place, percent: Math.round(chance(a, b)) }) : place;
  };

  const draw = (): void => {
    width = canvas.clientWidth || width;
    const scale = devicePixelRatio || 1;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(HEIGHT * scale);
    const pen = canvas.getContext('2d');
    if (!pen) return;
    const style = getComputedStyle(canvas);
    const colour = (name: string): string => style.getPropertyValue(name).trim();
    pen.scale(scale, scale);
    const dot = (place: number): number => Math.round(place * scale) / scale;
    const moved = others(parameters, hub.parameters).length > 0;
    pen.globalAlpha = moved ? 0.35 : 1;
    share.forEach((row, i) => row.forEach((percent, j) => {
      pen.fillStyle = mix(colour('--share-none'), colour('--share-all'), percent / 100);
      // On whole pixels, so that neighbours neither overlap nor leave gaps.
      const [left, top] = [dot(x(xs[i]!)), dot(y(ys[j + 1]!))];
      pen.fillRect(left, top, dot(x(xs[i + 1]!)) - left, dot(y(ys[j]!)) - top);
    }));
    pen.globalAlpha = 1;
    axes(pen, colour('--ink'), colour('--quiet'));
    lines(pen, colour('--ink'), colour('--card'));
    const { alpha_p: a, alpha_u: b } = hub.parameters;
    if (typeof a === 'number' && typeof b === 'number') mark(pen, x(Math.min(a, xMost)), y(Math.min(b, yMost)), colour('--card'), colour('--ink'));
    if (cursor && document.activeElement === canvas) {
      pen.strokeStyle = colour('--focus');
      pen.lineWidth = 2;
      pen.strokeRect(x(cursor[0]) - 8, y(cursor[1]) - 8, 16, 16);
    }
  };

  const axes = (pen: CanvasRenderingContext2D, ink: string, quiet: string): void => {
    pen.strokeStyle = quiet;
    pen.lineWidth = 1;
    pen.strokeRect(LEFT, y(yMost), x(xMost) - LEFT, y(0) - y(yMost));
    pen.fillStyle = ink;
    pen.font = '11px system-ui, sans-serif';
    for (const tick of [0, 0.25, 0.5, 0.75, 1]) {
      pen.textAlign = 'center';
      if (tick <= xMost) pen.fillText(String(tick), x(tick), HEIGHT - BELOW + 14);
      pen.textAlign = 'right';
      if (tick <= yMost) pen.fillText(String(tick), LEFT - 5, y(tick) + 4);
    }
    pen.font = 'italic 13px Georgia, serif';
    pen.textAlign = 'center';
    pen.fillText(say('diagram.across'), (LEFT + width - RIGHT) / 2, HEIGHT - 3);
    pen.save();
    pen.translate(10, HEIGHT / 2 - 8);
    pen.rotate(-Math.PI / 2);
    pen.fillText(say('diagram.up'), 0, 0);
    pen.restore();
  };

  const lines = (pen: CanvasRenderingContext2D, ink: string, halo: string): void => {
    if (!curves) return;
    pen.save();
    pen.beginPath();
    pen.rect(LEFT, y(yMost), x(xMost) - LEFT, y(0) - y(yMost));
    pen.clip();
    curves.curves.forEach((curve, k) => {
      const path = new Path2D();
      let on = false;
      curve.alpha_p.forEach((a: number | null, i) => {
        const b: number | null = curve.alpha_u[i]!;
        // A line is interrupted where it is not defined.
        if (a === null || b === null) on = false;
        else {
          path[on ? 'lineTo' : 'moveTo'](x(a), y(b));
          on = true;
        }
      });
      for (const [stroke, line] of [[halo, 3.6], [ink, 1.5]] as const) {
        pen.strokeStyle = stroke;
        pen.lineWidth = line;
        pen.setLineDash(stroke === halo ? [] : DASHES[k % DASHES.length]!);
        pen.stroke(path);
      }
    });
    pen.restore();
  };

  const describe = (): void => {
    const names = others(parameters, hub.parameters);
    note.classList.toggle('warn', names.length > 0);
    note.textContent = names.length
      ? say('diagram.others', { names: names.join(', '), caption: said('diagram', caption) })
      : said('diagram', caption);
    if (curves && !curves.applies) note.append(say('diagram.no-theory'));
    if (curves?.elsewhere) note.append(say('diagram.elsewhere'));
  };
  const go = (a: number, b: number): void => hub.ask({ do: 'change', values: { alpha_p: round(a), alpha_u: round(b) } });
  // Theory takes the server a while: lines are requested only while they are visible.
  let visible = false, wanted = false;
  const askCurves = debounce(() => {
    if (!visible || !wanted) return;
    wanted = false;
    hub.ask({ do: 'curves' });
  }, 400);
  new IntersectionObserver(([entry]) => {
    visible = entry!.isIntersecting;
    if (visible) askCurves();
  }).observe(canvas);

  canvas.addEventListener('click', (event) => {
    const box = canvas.getBoundingClientRect();
    const a = ((event.clientX - box.left - LEFT) / (width - LEFT - RIGHT)) * xMost;
    const b = ((HEIGHT - BELOW - (event.clientY - box.top)) / (HEIGHT - BELOW - ABOVE)) * yMost;
    if (a < 0 || b < 0 || a > xMost || b > yMost) return;
    cursor = [a, b];
    go(a, b);
  });
  canvas.addEventListener('keydown', (event) => {
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] }[event.key];
    cursor ??= present();
    if (move) {
      const [i, j] = [cellOf(xs, cursor[0]) + move[0]!, cellOf(ys, cursor[1]) + move[1]!];
      cursor = [alpha_p[clamp(i, alpha_p.length)]!, alpha_u[clamp(j, alpha_u.length)]!];
      tell(cursor[0], cursor[1], 'diagram.go');
      draw();
    } else if (event.key === 'Enter' || event.key === ' ') go(...cursor);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  const present = (): [number, number] => [Number(hub.parameters.alpha_p) || 0, Number(hub.parameters.alpha_u) || 0];
  canvas.addEventListener('focus', () => { cursor ??= present(); draw(); });
  canvas.addEventListener('blur', draw);

  let asked = '', drawn = '';
  hub.on('cell', ({ parameters: now }) => {
    const { straight } = hub.model;
    ends.hidden = straight;
    for (const each of [canvas, here, legend, note]) each.hidden = !straight;
    if (!straight) return;
    const rest = JSON.stringify({ ...now, alpha_p: 0, alpha_u: 0 });
    if (rest !== asked) {
      asked = rest;
      wanted = true;
      askCurves();
    }
    const all = JSON.stringify(now);
    if (all === drawn) return;
    drawn = all;
    tell(...present(), 'diagram.here');
    describe();
    draw();
  });
  hub.on('curves', (found) => {
    curves = found;
    legend.replaceChildren(...found.curves.map((curve, k) => h('li', {}, sample(DASHES[k % DASHES.length]!), mathematics(worded(curve.name)))));
    describe();
    draw();
  });
  hub.on('look', draw);
  new ResizeObserver(draw).observe(canvas);
  return panel('diagram', say('diagram.title'), true, canvas, here, legend, note, ends);
}

function mark(pen: CanvasRenderingContext2D, x: number, y: number, fill: string, edge: string): void {
  pen.beginPath();
  pen.arc(x, y, 6, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.strokeStyle = edge;
  pen.lineWidth = 2.5;
  pen.fill();
  pen.stroke();
}

function sample(dash: number[]): Element {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 30 6');
  svg.setAttribute('aria-hidden', 'true');
  svg.innerHTML = `<path d="M0 3H30" stroke="currentColor" stroke-width="1.6" stroke-dasharray="${dash.join(' ')}"/>`;
  return svg;
}

/** Names of lines as in the figures, without their abbreviations and typesetting. */
function worded(name: string): string {
  return name
    .replace(/\$(.*)\$/, (_, tex: string) => tex.replaceAll('\\alpha', 'α').replace('^{(r)}', '⁽ʳ⁾'))
    .replace(/^U (.*)/, (_, rest: string) => say('diagram.one-way', { rest }))
    .replace(/^C exists(.*)/, (_, rest: string) => say('diagram.exist', { rest }))
    .replace(/^C (.*)/, (_, rest: string) => say('diagram.two', { rest }));
}

const clamp = (k: number, count: number): number => Math.min(count - 1, Math.max(0, k));
const round = (value: number): number => Number(value.toPrecision(3));
