/* cloud/neighbours.c: a balanced k-d tree over float points (Friedman, Bentley and Finkel 1977), split at the median
 * of the widest axis, leaves of a few points kept contiguous. Exact; ties broken by row. */
#include "cloud/neighbours.h"

#include "cloud/all_nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    LEAF_SIZE = 12,
    MAXIMUM_DEPTH = 64,
    FEW_HITS = 40, /* sorted faster by insertion */
    RUN = 8        /* of a merge sort, begun by insertion */
};

typedef struct tree_node {
    uint32_t begin, end; /* points of the node, in tree order */
    uint32_t right;      /* index of the right child; the left one follows its parent; 0 for a leaf */
    uint32_t least_row;  /* of its points: of many at one place, only the first rows are worth a visit */
    float low[3], high[3];
} tree_node;

struct plm_index {
    size_t count;
    const float (*xyz)[3]; /* the caller's */
    float (*point)[3];     /* in tree order */
    uint32_t *row;         /* tree order -> caller's row */
    tree_node *node;
    size_t node_count;
};

typedef struct builder {
    const float (*xyz)[3];
    uint32_t *row;
    tree_node *node;
    size_t node_count;
} builder;

static bool before(const builder *b, int axis, uint32_t i, uint32_t j)
{
    const float x = b->xyz[i][axis], y = b->xyz[j][axis];
    return x < y || (x == y && i < j);
}

/* Hoare's selection: after it, row[middle] is in its sorted place along axis. Rows are distinct, so no ties remain. */
static void select_median(builder *b, int axis, size_t begin, size_t end, size_t middle)
{
    uint32_t *row = b->row;
    size_t low = begin, high = end - 1;
    while (low < high) {
        const uint32_t pivot = row[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;;) {
            while (before(b, axis, row[i], pivot)) i++;
            while (before(b, axis, pivot, row[j])) j--;
            if (i >= j) break;
            const uint32_t other = row[i];
            row[i++] = row[j];
            row[j--] = other;
        }
        if (i == j) { /* both stopped on the pivot itself */
            if (i == middle) return;
            if (middle < i)
                high = i - 1;
            else
                low = i + 1;
        } else if (middle <= j) {
            high = j;
        } else {
            low = i;
        }
    }
}

static uint32_t build_node(builder *b, size_t begin, size_t end)
{
    const uint32_t self = (uint32_t)b->node_count++;
    tree_node *node = &b->node[self];
    *node = (tree_node){.begin = (uint32_t)begin, .end = (uint32_t)end, .least_row = PLM_NO_ROW};
    for (int axis = 0; axis < 3; axis++) node->low[axis] = INFINITY, node->high[axis] = -INFINITY;
    for (size_t i = begin; i < end; i++) {
        if (b->row[i] < node->least_row) node->least_row = b->row[i];
        for (int axis = 0; axis < 3; axis++) {
            const float x = b->xyz[b->row[i]][axis];
            if (x < node->low[axis]) node->low[axis] = x;
            if (x > node->high[axis]) node->high[axis] = x;
        }
    }
    if (end - begin <= LEAF_SIZE) return self;
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (node->high[i] - node->low[i] > node->high[axis] - node->low[axis]) axis = i;
    const size_t middle = begin + (end - begin) / 2;
    select_median(b, axis, begin, end, middle);
    build_node(b, begin, middle);
    node->right = build_node(b, middle, end);
    return self;
}

plm_status plm_index_build(const float (*xyz)[3], size_t count, plm_index **out, plm_error *error)
{
    if (count >= UINT32_MAX) return plm_fail(error, PLM_E_ARGUMENT, "%zu points are too many for one index", count);
    plm_index *index = plm_alloc_zero(1, sizeof *index, error);
    if (!index) return PLM_E_MEMORY;
    index->count = count;
    index->xyz = xyz;
    index->point = plm_alloc(count, sizeof *index->point, error);
    index->row = plm_alloc(count, sizeof *index->row, error);
    /* A leaf holds at least LEAF_SIZE / 2 points, and there are as many inner nodes as leaves, less one. */
    index->node = plm_alloc(count / (LEAF_SIZE / 2) * 2 + 3, sizeof *index->node, error);
    if (!index->point || !index->row || !index->node) {
        plm_index_free(index);
        return PLM_E_MEMORY;
    }
    for (size_t i = 0; i < count; i++) index->row[i] = (uint32_t)i;
    builder b = {xyz, index->row, index->node, 0};
    if (count) build_node(&b, 0, count);
    index->node_count = b.node_count;
    for (size_t i = 0; i < count; i++) {
        memcpy(index->point[i], xyz[index->row[i]], sizeof index->point[i]);
    }
    *out = index;
    return PLM_OK;
}

void plm_index_free(plm_index *index)
{
    if (!index) return;
    plm_free(index->point);
    plm_free(index->row);
    plm_free(index->node);
    plm_free(index);
}

static float box_distance(const tree_node *node, const float q[3])
{
    float sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        const float below = node->low[axis] - q[axis], above = q[axis] - node->high[axis];
        const float d = below > above ? below : above;
        if (d > 0) sum += d * d;
    }
    return sum;
}

static float point_distance(const float a[3], const float b[3])
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/** The best found so far, sorted by (distance, row): a key holds the bits of the squared distance, which order as the numbers do
 * where those are not negative, above the row. */
typedef struct best_list {
    size_t count, room;
    uint64_t key[PLM_MOST_NEIGHBOURS];
} best_list;

static uint64_t key_of(float squared, uint32_t row)
{
    uint32_t bits;
    memcpy(&bits, &squared, sizeof bits);
    return (uint64_t)bits << 32 | row;
}

static float squared_of(uint64_t key)
{
    const uint32_t bits = (uint32_t)(key >> 32);
    float squared;
    memcpy(&squared, &bits, sizeof squared);
    return squared;
}

static void best_insert(best_list *best, uint64_t key)
{
    size_t i = best->count;
    if (i == best->room) {
        if (key >= best->key[i - 1]) return;
        i--;
    } else {
        best->count++;
    }
    if (i > FEW_HITS) { /* halving, then moving as one block */
        size_t low = 0, high = i;
        while (low < high) {
            const size_t middle = (low + high) / 2;
            if (best->key[middle] > key)
                high = middle;
            else
                low = middle + 1;
        }
        memmove(&best->key[low + 1], &best->key[low], (i - low) * sizeof *best->key);
        i = low;
    } else {
        for (; i > 0 && best->key[i - 1] > key; i--) best->key[i] = best->key[i - 1];
    }
    best->key[i] = key;
}

static void search_nearest(const plm_index *index, const float q[3], uint32_t skip, best_list *best)
{
    struct {
        uint32_t node;
        float distance;
    } stack[MAXIMUM_DEPTH];
    int depth = 0;
    if (index->node_count) {
        stack[depth].node = 0;
        stack[depth++].distance = box_distance(&index->node[0], q);
    }
    while (depth) {
        depth--;
        const uint32_t self = stack[depth].node;
        const tree_node *node = &index->node[self];
        if (best->count == best->room) {
            if (key_of(stack[depth].distance, node->least_row) > best->key[best->count - 1]) continue;
        }
        if (!node->right) {
            for (uint32_t i = node->begin; i < node->end; i++)
                if (index->row[i] != skip) best_insert(best, key_of(point_distance(index->point[i], q), index->row[i]));
            continue;
        }
        const float left = box_distance(&index->node[self + 1], q);
        const float right = box_distance(&index->node[node->right], q);
        const bool left_first = left <= right; /* the nearer child is pushed last, so that it is visited first */
        stack[depth].node = left_first ? node->right : self + 1;
        stack[depth++].distance = left_first ? right : left;
        stack[depth].node = left_first ? self + 1 : node->right;
        stack[depth++].distance = left_first ? left : right;
    }
}

static void best_write(const best_list *best, size_t k, uint32_t *row, float *squared)
{
    for (size_t i = 0; i < k; i++) {
        if (row) row[i] = i < best->count ? (uint32_t)best->key[i] : PLM_NO_ROW;
        if (squared) squared[i] = i < best->count ? squared_of(best->key[i]) : INFINITY;
    }
}

static size_t ask(const plm_index *index, const float query[3], uint32_t skip, size_t k, uint32_t *row, float *squared)
{
    best_list best;
    best.count = 0;
    best.room = k < PLM_MOST_NEIGHBOURS ? k : PLM_MOST_NEIGHBOURS;
    if (k) search_nearest(index, query, skip, &best);
    best_write(&best, k, row, squared);
    return best.count;
}

size_t plm_index_nearest(const plm_index *index, const float query[3], size_t k, uint32_t *row, float *squared)
{
    return ask(index, query, PLM_NO_ROW, k, row, squared);
}

size_t plm_index_neighbours(const plm_index *index, uint32_t point, size_t k, uint32_t *row, float *squared)
{
    return ask(index, index->xyz[point], point, k, row, squared);
}

typedef struct hit {
    float squared;
    uint32_t row;
} hit;

static bool hit_before(hit a, hit b)
{
    return a.squared < b.squared || (a.squared == b.squared && a.row < b.row);
}

/* In place over two arrays, by distance, then row: no allocation, and the same order for any input order. */
static void heap_sort(uint32_t *row, float *squared, size_t count)
{
    for (size_t phase = count / 2 + count; phase-- > 0;) {
        size_t root, end;
        if (phase >= count) { /* building the heap */
            root = phase - count;
            end = count;
        } else { /* taking the largest off */
            root = 0;
            end = phase;
            const hit top = {squared[0], row[0]};
            squared[0] = squared[end];
            row[0] = row[end];
            squared[end] = top.squared;
            row[end] = top.row;
        }
        for (size_t child; (child = 2 * root + 1) < end; root = child) {
            hit larger = {squared[child], row[child]};
            if (child + 1 < end) {
                const hit right = {squared[child + 1], row[child + 1]};
                if (hit_before(larger, right)) larger = right, child++;
            }
            const hit here = {squared[root], row[root]};
            if (!hit_before(here, larger)) break;
            squared[root] = larger.squared;
            row[root] = larger.row;
            squared[child] = here.squared;
            row[child] = here.row;
        }
    }
}

/* Merges sorted runs of `run` keys two by two. */
static void merge_runs(const uint64_t *from, uint64_t *to, size_t count, size_t run)
{
    for (size_t begin = 0; begin < count; begin += 2 * run) {
        const size_t middle = begin + run < count ? begin + run : count,
                     end = begin + 2 * run < count ? begin + 2 * run : count;
        size_t left = begin, right = middle;
        for (size_t k = begin; k < end; k++) {
            const bool takes_left = left < middle && (right == end || from[left] < from[right]);
            to[k] = takes_left ? from[left++] : from[right++];
        }
    }
}

/* The same by keys, which compare as one number. */
static void merge_sort(uint32_t *row, float *squared, size_t count)
{
    uint64_t here[PLM_MOST_NEIGHBOURS], there[PLM_MOST_NEIGHBOURS], *from = here, *to = there;
    for (size_t i = 0; i < count; i++) {
        const uint64_t key = key_of(squared[i], row[i]);
        size_t j = i;
        for (; j % RUN > 0 && here[j - 1] > key; j--) here[j] = here[j - 1];
        here[j] = key;
    }
    for (size_t run = RUN; run < count; run *= 2) {
        merge_runs(from, to, count, run);
        uint64_t *const merged = to;
        to = from, from = merged;
    }
    for (size_t i = 0; i < count; i++) row[i] = (uint32_t)from[i], squared[i] = squared_of(from[i]);
}

static void sort_hits(uint32_t *row, float *squared, size_t count)
{
    if (count <= PLM_MOST_NEIGHBOURS)
        merge_sort(row, squared, count);
    else
        heap_sort(row, squared, count);
}

/** Where plm_neighbour_table writes. */
typedef struct table {
    size_t k;
    uint32_t *row;
    float *squared;
} table;

static void write_line(void *user, const plm_neighbourhood *found)
{
    const table *to = user;
    uint32_t row[PLM_MOST_NEIGHBOURS];
    float squared[PLM_MOST_NEIGHBOURS];
    for (size_t i = 0; i < found->count; i++) squared[i] = found->squared[i], row[i] = found->row[found->place[i]];
    sort_hits(row, squared, found->count);
    const size_t line = found->point_row * to->k;
    for (size_t i = 0; i < to->k; i++) {
        if (to->row) to->row[line + i] = i < found->count ? row[i] : PLM_NO_ROW;
        if (to->squared) to->squared[line + i] = i < found->count ? squared[i] : INFINITY;
    }
}

plm_status plm_neighbour_table(const float (*xyz)[3], size_t count, size_t k, uint32_t *row, float *squared,
                               plm_error *error)
{
    table to = {k, row, squared};
    return plm_all_nearest(xyz, count, k, write_line, &to, error);
}

plm_status plm_index_table(const plm_index *index, size_t k, uint32_t *row, float *squared, plm_error *error)
{
    return plm_neighbour_table(index->xyz, index->count, k, row, squared, error);
}

size_t plm_index_ball(const plm_index *index, const float query[3], float radius, size_t room, uint32_t *row,
                      float *squared)
{
    const float limit = radius * radius;
    uint32_t stack[MAXIMUM_DEPTH];
    int depth = 0;
    size_t found = 0;
    if (index->node_count) stack[depth++] = 0;
    while (depth) {
        const uint32_t self = stack[--depth];
        const tree_node *node = &index->node[self];
        if (box_distance(node, query) > limit) continue;
        if (node->right) {
            stack[depth++] = node->right;
            stack[depth++] = self + 1;
            continue;
        }
        for (uint32_t i = node->begin; i < node->end; i++) {
            const float d = point_distance(index->point[i], query);
            if (d > limit) continue;
            if (found < room) {
                row[found] = index->row[i];
                squared[found] = d;
            }
            found++;
        }
    }
    sort_hits(row, squared, found < room ? found : room);
    return found;
}
