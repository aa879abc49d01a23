// The picture to save: cylinder and map side by side, as shown.

import { say } from '../words/say';

/** Draw groups of canvases side by side on the background of the page. */
export function drawBeside(picture: HTMLCanvasElement, groups: HTMLCanvasElement[][], behind: HTMLElement): void {
  const sizes = groups.map((group) => ({
    width: Math.max(...group.map((canvas) => canvas.width)),
    height: Math.max(...group.map((canvas) => canvas.height)),
  }));
  // Movies need even numbers.
  const width = 2 * Math.ceil(sizes.reduce((sum, size) => sum + size.width, 0) / 2);
  const height = 2 * Math.ceil(Math.max(...sizes.map((size) => size.height)) / 2);
  if (picture.width !== width) picture.width = width;
  if (picture.height !== height) picture.height = height;
  const context = picture.getContext('2d')!;
  context.fillStyle = background(behind);
  context.fillRect(0, 0, width, height);
  let x = 0;
  groups.forEach((group, k) => {
    for (const canvas of group) context.drawImage(canvas, x, (height - canvas.height) / 2);
    x += sizes[k].width;
  });
}

/** The same as a file. */
export async function pngOf(groups: HTMLCanvasElement[][], behind: HTMLElement): Promise<Blob> {
  const picture = document.createElement('canvas');
  drawBeside(picture, groups, behind);
  return new Promise((resolve, reject) => {
    picture.toBlob((blob) => (blob ? resolve(blob) : reject(new Error(say('files.no-picture')))), 'image/png');
  });
}

/** The first background that is not transparent, outwards from an element. */
function background(element: HTMLElement): string {
  for (let at: HTMLElement | null = element; at; at = at.parentElement) {
    const colour = getComputedStyle(at).backgroundColor;
    if (colour && colour !== 'transparent' && !/, 0\)$|\/ 0\)$/.test(colour)) return colour;
  }
  return '#ffffff';
}
