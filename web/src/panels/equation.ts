import type { Hub } from './hub';
import { h, mathematics, panel } from './dom';

/** The filament equation; each term explains what it does. */
export function equation(hub: Hub): HTMLElement {
  const caption = h('p', { id: 'term', class: 'note', 'aria-live': 'polite' }, 'Choose a term to read what it does.');
  const buttons = hub.about.terms.map((term, k) => {
    const negative = /^[-−]/.test(term.formula);
    const sign = negative ? '− ' : k > 0 ? '+ ' : '';
    const button = h('button', {
      class: 'term', 'data-term': term.name, 'aria-pressed': 'false', title: term.name.replaceAll('_', ' '),
      onclick: () => {
        buttons.forEach((other) => other.setAttribute('aria-pressed', String(other === button)));
        caption.replaceChildren(h('strong', {}, `${term.name.replaceAll('_', ' ')}: `), term.caption);
      },
    }, sign, mathematics(term.formula.replace(/^[-−]\s*/, '')));
    return button;
  });
  return panel(
    'equation', 'The equation', false,
    h('p', { class: 'equation' }, h('span', {}, mathematics('∂P/∂t = ')), ...buttons),
    caption,
    h('p', { class: 'equation quiet' }, mathematics('−μ ∇²u + u + Π₀ e_z + ∇Π′ = |P|ⁿ P,  ∇·u = 0')),
    h('p', { class: 'note' }, 'P is the local direction and order of the actin filaments, u the flow that motors on them drive: it responds to the filaments at once, balanced by friction.'),
  );
}
