// Tables: columns and rows have heads, and wide ones scroll in a box of their own.

// The box, which keys can scroll.
function table_box(title, size = '') {
  return element('div', { className: `table-box ${size}`, tabIndex: 0, role: 'region', 'aria-label': title });
}

// Stays in sight where the table is wider than the window.
const table_caption = (text) => element('caption', {}, element('span', {}, text));

function table_head(columns) {
  const heads = columns.map(({ name, text }) => element('th', { scope: 'col', className: text ? 'text' : '' }, name));
  return element('thead', {}, element('tr', {}, ...heads));
}

function table_row(head, values) {
  return element('tr', {}, element('th', { scope: 'row' }, head), ...values.map((value) => element('td', {}, value)));
}
