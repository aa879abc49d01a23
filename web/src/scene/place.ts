/** Stack canvases so that they fill their host. */
export function place(host: HTMLElement, ...canvases: HTMLCanvasElement[]): void {
  if (getComputedStyle(host).position === 'static') host.style.position = 'relative';
  for (const canvas of canvases) {
    Object.assign(canvas.style, { position: 'absolute', left: '0', top: '0', width: '100%', height: '100%' });
    host.append(canvas);
  }
}
