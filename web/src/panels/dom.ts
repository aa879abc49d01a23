type Child = Node | string | null | undefined | false;
type Attributes = Record<string, unknown>;

/** An element with attributes (`on…` listeners, `class`, properties such as `value`) and children. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value as EventListener);
    else if (name === 'value' || name === 'checked' || name === 'selected') (element as never as Attributes)[name] = value;
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(...children.filter((child): child is Node | string => Boolean(child)));
  return element;
}

/** A panel that folds, with its title; in narrow windows all but two start folded. */
export function panel(id: string, title: string, open: boolean, ...children: Child[]): HTMLDetailsElement {
  const heading = h('h2', {}, title);
  return h('details', { class: 'panel', id: `panel-${id}`, open }, h('summary', {}, heading), h('div', { class: 'body' }, ...children));
}

/** Whether an element handles keys by itself. */
export function takesKeys(target: EventTarget | null): boolean {
  return target instanceof HTMLElement && target.closest('input, select, textarea, button, summary, a, dialog') !== null;
}
