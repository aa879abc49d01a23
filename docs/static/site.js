// What the theme leaves out for readers who use a keyboard or hear the page.

// Two landmarks of one kind need names.
document.querySelector('aside.sidebar-drawer')?.setAttribute('aria-label', 'All pages');
document.querySelector('aside.toc-drawer')?.setAttribute('aria-label', 'This page');

// A heading has a level.
for (const each of document.querySelectorAll('[role="heading"]:not([aria-level])')) each.setAttribute('aria-level', '2');

// What scrolls sideways must be reached by the keyboard.
const scrolling = 'article pre, article .table-wrapper, article div.math';
const reach = () => {
  for (const each of document.querySelectorAll(scrolling)) {
    if (each.scrollWidth > each.clientWidth + 1) each.tabIndex = 0;
    else each.removeAttribute('tabindex');
  }
};
addEventListener('load', reach);
addEventListener('resize', reach);
