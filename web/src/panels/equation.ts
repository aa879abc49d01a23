import type { Hub } from './hub';
import { h, panel } from './dom';
import { prose } from './prose';
import { mathematics } from './mathematics';
import { said, say } from '../words/say';

const name = (term: string): string => said(`term.${term}`, term.replaceAll('_', ' '));

/** The filament equation; each term explains what it does. */
export function equation(hub: Hub): HTMLElement {
  const caption = h('p', { id: 'term', class: 'note', 'aria-live': 'polite' }, say('equation.choose'));
  const buttons = hub.about.terms.map((term, k) => {
    const negative = /^[-−]/.test(term.formula);
    const sign = negative ? '− ' : k > 0 ? '+ ' : '';
    const button = h('button', {
      class: 'term', 'data-term': term.name, 'aria-pressed': 'false', title: name(term.name),
      onclick: () => {
        buttons.forEach((other) => other.setAttribute('aria-pressed', String(other === button)));
        caption.replaceChildren(h('strong', {}, `${name(term.name)}: `), ...prose(said(`term.${term.name}.caption`, term.caption)));
      },
    }, sign, mathematics(term.formula.replace(/^[-−]\s*/, '')));
    return button;
  });
  return panel(
    'equation', say('equation.title'), false,
    h('p', { class: 'equation' }, h('span', {}, mathematics('∂P/∂t = ')), ...buttons),
    caption,
    h('p', { class: 'equation quiet' }, mathematics('−μ ∇²u + u + Π₀ e_z + ∇Π′ = |P|ⁿ P,  ∇·u = 0')),
    h('p', { class: 'note' }, ...prose(say('equation.text'))),
  );
}
