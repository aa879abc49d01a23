import type { Hub } from './hub';
import { h } from './dom';
import { say } from '../words/say';

/** Kinds of movies, the most widely played first. */
const KINDS: [type: string, ending: string][] = [
  ['video/mp4;codecs=avc1.42E01F', 'mp4'], ['video/webm;codecs=vp9', 'webm'], ['video/webm;codecs=vp8', 'webm'], ['video/webm', 'webm'],
];
const PER_SECOND = 30;
const BITS_PER_SECOND = 6_000_000;

/** What is recorded. */
export interface Film {
  /** Draw the picture of this moment. */
  draw(onto: HTMLCanvasElement): void;
  save(movie: Blob, name: string): void;
}

/** The first kind of movie that this browser can record, or none. */
export function recordable(supported: (type: string) => boolean): [type: string, ending: string] | undefined {
  return KINDS.find(([type]) => supported(type));
}

/** A button that records the pictures of the cell until it is pressed again, on the device alone. */
export function recordButton(hub: Hub, film: Film): HTMLElement {
  let stop: (() => void) | null = null;
  const state = h('span', { class: 'note', role: 'status' });
  const button = h('button', { id: 'record', 'aria-pressed': 'false', title: say('record.title'), onclick: () => (stop ? stop() : begin()) }, say('record.begin'));
  const begin = (): void => {
    const kind = typeof MediaRecorder === 'undefined' ? undefined : recordable((type) => MediaRecorder.isTypeSupported(type));
    if (!kind || !('captureStream' in HTMLCanvasElement.prototype)) {
      hub.toast(say('record.impossible'));
      return;
    }
    const [mimeType, ending] = kind;
    const canvas = document.createElement('canvas');
    film.draw(canvas);
    const stream = canvas.captureStream(PER_SECOND);
    const recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: BITS_PER_SECOND });
    const parts: Blob[] = [];
    const began = performance.now();
    let drawn = began;
    const draw = (now: number): void => {
      if (recorder.state === 'inactive') return;
      requestAnimationFrame(draw);
      if (now - drawn < 1000 / PER_SECOND - 4) return; // pictures come a little early or late
      drawn = now;
      film.draw(canvas);
      const words = say('record.going', { seconds: Math.floor((now - began) / 1000) });
      if (state.textContent !== words) state.textContent = words;
    };
    recorder.ondataavailable = ({ data }) => data.size && parts.push(data);
    recorder.onstop = () => {
      stream.getTracks().forEach((track) => track.stop());
      stop = null;
      button.setAttribute('aria-pressed', 'false');
      button.textContent = say('record.begin');
      state.textContent = '';
      if (parts.length) film.save(new Blob(parts, { type: mimeType }), `cyclosis.${ending}`);
      else hub.toast(say('record.empty'));
    };
    recorder.onerror = () => recorder.stop();
    recorder.start(1000);
    stop = () => recorder.stop();
    button.setAttribute('aria-pressed', 'true');
    button.textContent = say('record.end');
    requestAnimationFrame(draw);
  };
  return h('div', { class: 'row wrap' }, button, state);
}
