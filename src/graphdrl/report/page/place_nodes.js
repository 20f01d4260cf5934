// Places for the nodes of a graph that has no coordinates: PivotMDS [Brandes and Pich 2006, "Eigensolver methods for
// progressive multidimensional scaling of large data"], on distances in edges. O(pivots × (nodes + edges)). Smaller
// graphs are then refined, so that nodes do not lie on each other.

const kPivots = 24;
const kMostRefined = 1000; // nodes; a round takes time and all distances memory quadratic in them
const kRefinements = 50;

function neighbour_lists(node_count, edges) {
  const offsets = new Uint32Array(node_count + 1);
  for (const node of edges) ++offsets[node + 1];
  for (let node = 0; node < node_count; ++node) offsets[node + 1] += offsets[node];
  const next = offsets.slice();
  const targets = new Uint32Array(edges.length);
  for (let i = 0; i < edges.length; i += 2) {
    targets[next[edges[i]]++] = edges[i + 1];
    targets[next[edges[i + 1]]++] = edges[i];
  }
  return { offsets, targets };
}

// Edges from `start` to each node; nodes out of reach are two further than the farthest in reach.
function distances_from(start, node_count, { offsets, targets }) {
  const distances = new Float64Array(node_count).fill(-1);
  const queue = new Uint32Array(node_count);
  let end = 1;
  queue[0] = start;
  distances[start] = 0;
  for (let i = 0; i < end; ++i) {
    const node = queue[i];
    for (let k = offsets[node]; k < offsets[node + 1]; ++k) {
      if (distances[targets[k]] >= 0) continue;
      distances[targets[k]] = distances[node] + 1;
      queue[end++] = targets[k];
    }
  }
  const beyond = distances[queue[end - 1]] + 2;
  return distances.map((distance) => (distance < 0 ? beyond : distance));
}

// Distances to pivots, each pivot the node farthest from those before it.
function pivot_distances(node_count, lists) {
  const nearest = new Float64Array(node_count).fill(Infinity);
  const columns = [];
  let pivot = 0;
  while (columns.length < Math.min(kPivots, node_count)) {
    const column = distances_from(pivot, node_count, lists);
    columns.push(column);
    for (let node = 0; node < node_count; ++node) nearest[node] = Math.min(nearest[node], column[node]);
    for (let node = 0; node < node_count; ++node) {
      if (nearest[node] > nearest[pivot]) pivot = node;
    }
  }
  return columns;
}

// Squares, with the means of rows and columns taken away.
function centre(columns, node_count) {
  const row_means = new Float64Array(node_count);
  let mean = 0;
  for (const column of columns) {
    for (let node = 0; node < node_count; ++node) {
      column[node] *= column[node];
      row_means[node] += column[node] / columns.length;
    }
  }
  for (const value of row_means) mean += value / node_count;
  for (const column of columns) {
    let column_mean = 0;
    for (const value of column) column_mean += value / node_count;
    for (let node = 0; node < node_count; ++node) {
      column[node] = -0.5 * (column[node] - row_means[node] - column_mean + mean);
    }
  }
}

const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);

// The leading eigenvector of a small symmetric matrix, orthogonal to those found before, by power iteration.
function leading_vector(matrix, before) {
  let vector = matrix.map((_, i) => Math.sin(i + 1 + before.length));
  for (let round = 0; round < 100; ++round) {
    for (const other of before) {
      const share = dot(vector, other);
      vector = vector.map((value, i) => value - share * other[i]);
    }
    vector = matrix.map((row) => dot(row, vector));
    const length = Math.sqrt(dot(vector, vector));
    if (length < 1e-12) return vector.fill(0);
    vector = vector.map((value) => value / length);
  }
  return vector;
}

// Stress majorization [Gansner, Koren and North 2004, "Graph drawing by stress majorization"], one node at a time:
// every other node draws it to the right distance, with weight 1 / distance².
function refine([x, y], node_count, lists) {
  const all = Array.from({ length: node_count }, (_, node) => distances_from(node, node_count, lists));
  for (let round = 0; round < kRefinements; ++round) {
    for (let node = 0; node < node_count; ++node) {
      let [sum_x, sum_y, sum] = [0, 0, 0];
      for (let other = 0; other < node_count; ++other) {
        if (other === node) continue;
        const wanted = all[node][other];
        const weight = 1 / (wanted * wanted);
        const [dx, dy] = [x[node] - x[other], y[node] - y[other]];
        const stretch = wanted / Math.max(Math.sqrt(dx * dx + dy * dy), 1e-6);
        sum_x += weight * (x[other] + dx * stretch);
        sum_y += weight * (y[other] + dy * stretch);
        sum += weight;
      }
      if (sum === 0) continue;
      x[node] = sum_x / sum;
      y[node] = sum_y / sum;
    }
  }
}

// Centred, and as large as distances in edges ask for: the leading axis spans the longest distance.
function rescale(places, longest) {
  const span = places[0].reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  const factor = span > 0 ? longest / (2 * span) : 0;
  // Nodes in one place would never separate.
  return places.map((axis) => axis.map((value, i) => value * factor + 1e-3 * Math.sin(i)));
}

// The x and y of every node.
function place_nodes(node_count, edges) {
  const lists = neighbour_lists(node_count, edges);
  const columns = pivot_distances(node_count, lists);
  const longest = columns[0].reduce((most, distance) => Math.max(most, distance), 0);
  centre(columns, node_count);
  const matrix = columns.map((a) => columns.map((b) => dot(a, b)));
  const vectors = [];
  for (let axis = 0; axis < 2; ++axis) vectors.push(leading_vector(matrix, vectors));
  const places = vectors.map((vector) => {
    const along = new Float32Array(node_count);
    columns.forEach((column, i) => {
      for (let node = 0; node < node_count; ++node) along[node] += vector[i] * column[node];
    });
    return along;
  });
  const scaled = rescale(places, longest);
  if (node_count <= kMostRefined) refine(scaled, node_count, lists);
  return scaled;
}
