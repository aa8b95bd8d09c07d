"""Gradient-boosted trees that C headers of segment/ hold: learnt by train_ghosts.py and train_tubes.py."""
import numpy as np

DEPTH = 5  # segment/forest.h has trees of 2 ** DEPTH - 1 nodes
RATE, BINS, RIDGE = 0.3, 48, 20.0
CELLS = 64  # of histograms, at least BINS


def best_splits(binned, edges, node, gradient, hessian, leaves):
    g_all, h_all = np.bincount(node, gradient, leaves), np.bincount(node, hessian, leaves)
    gain, feature, place = np.full(leaves, 1e-6), np.zeros(leaves, int), np.full(leaves, 255)
    for f, edge in enumerate(edges):
        cell = node * CELLS + binned[f]
        g = np.bincount(cell, gradient, leaves * CELLS).reshape(leaves, CELLS).cumsum(1)
        h = np.bincount(cell, hessian, leaves * CELLS).reshape(leaves, CELLS).cumsum(1)
        won = (g ** 2 / (h + RIDGE) + (g_all[:, None] - g) ** 2 / (h_all[:, None] - h + RIDGE)
               - (g_all ** 2 / (h_all + RIDGE))[:, None])
        won[:, len(edge):] = 0
        at = won.argmax(1)
        top = won[np.arange(leaves), at]
        better = top > gain
        gain[better], feature[better], place[better] = top[better], f, at[better]
    return feature, place


def boost(x, y, w, count):
    """Bias and count trees (splits, and what each leaf adds to the logarithm of the odds) that tell y from features x, rows weighing w."""
    edges = [np.unique(np.quantile(x[::4, f], np.linspace(0, 1, BINS + 1)[1:-1]).astype(np.float32))
             for f in range(x.shape[1])]
    binned = np.stack([np.searchsorted(edges[f], x[:, f], side="left") for f in range(x.shape[1])]).astype(np.uint8)
    bias = np.log((w * y).sum() / (w * (1 - y)).sum())
    score, trees, row = np.full(len(y), bias), [], np.arange(len(y))
    for _ in range(count):
        p = 1 / (1 + np.exp(-score))
        gradient, hessian = w * (p - y), w * p * (1 - p)
        node, tree = np.zeros(len(y), int), []
        for depth in range(DEPTH):
            feature, place = best_splits(binned, edges, node, gradient, hessian, 1 << depth)
            tree += [(int(f), float(edges[f][k]) if k < 255 else np.inf) for f, k in zip(feature, place)]
            node = 2 * node + (binned[feature[node], row] > place[node])
        g, h = np.bincount(node, gradient, 1 << DEPTH), np.bincount(node, hessian, 1 << DEPTH)
        leaf = -RATE * g / (h + RIDGE)
        score += leaf[node]
        trees.append((tree, leaf))
    return bias, trees


def number(value):
    if np.isinf(value):
        return "INFINITY"
    text = f"{np.float32(value):.6g}"
    return text + ("F" if any(c in text for c in ".e") else ".0F")


def write(bias, trees, name, told, writer):
    """The header of segment/ to standard output: of what is told, in names that begin with `name`, by this script."""
    low = name.lower()
    print(f"/* segment/{low}_forest.h: the trees of {told}. Written by bench/accuracy/{writer}. Internal. */")
    print(f"#ifndef PLANTIMETER_SEGMENT_{name}_FOREST_H\n#define PLANTIMETER_SEGMENT_{name}_FOREST_H\n")
    print('#include "segment/forest.h"\n')
    print(f"static const double {name}_BIAS = {bias:.6g};\n/* clang-format off */")
    print(f"static const plm_tree {name}_TREE[{len(trees)}] = {{")
    for tree, leaf in trees:
        print("    {{" + ", ".join(str(f) for f, _ in tree) + "},")
        print("     {" + ", ".join(number(t) for _, t in tree) + "},")
        print("     {" + ", ".join(number(v) for v in leaf) + "}},")
    print("};\n/* clang-format on */\n\n#endif")
