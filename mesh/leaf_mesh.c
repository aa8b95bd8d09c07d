/* mesh/leaf_mesh.c: patches are put together by the points that they share, so the seam between two charts is closed
 * wherever both see the same triangles there. */
#include "mesh/leaf_mesh.h"

#include "cloud/linear.h"
#include "mesh/leaf_trim.h"

#include <math.h>
#include <string.h>

enum { PLACED_NEAR = 1, PLACED_OWN = 2 };

plm_status plm_leaf_draft_create(size_t point_count, plm_leaf_draft *draft, plm_error *error)
{
    plm_leaf_draft made = {.point_count = point_count};
    made.place = plm_alloc(point_count, sizeof *made.place, error);
    made.outward = plm_alloc_zero(point_count, sizeof *made.outward, error);
    made.placed = plm_alloc_zero(point_count, sizeof *made.placed, error);
    if (!made.place || !made.outward || !made.placed) {
        plm_leaf_draft_free(&made);
        return PLM_E_MEMORY;
    }
    *draft = made;
    return PLM_OK;
}

void plm_leaf_draft_free(plm_leaf_draft *draft)
{
    if (!draft) return;
    plm_free(draft->place);
    plm_free(draft->outward);
    plm_free(draft->placed);
    plm_free(draft->triangle);
    *draft = (plm_leaf_draft){0};
}

static plm_status make_room(plm_leaf_draft *draft, size_t more, plm_error *error)
{
    if (draft->count + more <= draft->room) return PLM_OK;
    const size_t room = 2 * draft->room + more;
    void *larger = plm_realloc(draft->triangle, room, sizeof *draft->triangle, error);
    if (!larger) return PLM_E_MEMORY;
    draft->triangle = larger;
    draft->room = room;
    return PLM_OK;
}

/* A side of a triangle with no leaf beyond: both ends lean away from the corner across. */
static void lean_outward(plm_leaf_draft *draft, const uint32_t corner[3], int across)
{
    const double *a = draft->place[corner[(across + 1) % 3]], *b = draft->place[corner[(across + 2) % 3]];
    const double *c = draft->place[corner[across]];
    double along[3], off[3];
    for (int i = 0; i < 3; i++) along[i] = b[i] - a[i], off[i] = a[i] - c[i];
    const double length = plm_normalise(along);
    const double part = plm_dot(off, along);
    for (int i = 0; i < 3; i++) off[i] -= part * along[i];
    if (!(plm_normalise(off) > 0)) return;
    for (int end = 1; end <= 2; end++)
        for (int i = 0; i < 3; i++) draft->outward[corner[(across + end) % 3]][i] += length * off[i];
}

plm_status plm_leaf_draft_add(plm_leaf_draft *draft, const plm_leaf_patch *patch, const uint8_t *state,
                              plm_error *error)
{
    const plm_triangulation *mesh = &patch->triangulation;
    const plm_status status = make_room(draft, mesh->count, error);
    if (status != PLM_OK) return status;
    for (size_t i = 0; i < patch->count; i++) {
        const uint32_t row = patch->row[i];
        const uint8_t how = patch->owner[i] == patch->self ? PLACED_OWN : PLACED_NEAR;
        if (draft->placed[row] >= how) continue;
        plm_leaf_chart_lift(&patch->chart, patch->uvz[i], draft->place[row]);
        draft->placed[row] = how;
    }
    for (size_t t = 0; t < mesh->count; t++) {
        if (state[t] == PLM_TRIANGLE_OUT || !plm_patch_owns(patch, t)) continue;
        uint32_t *triangle = draft->triangle[draft->count++];
        for (int i = 0; i < 3; i++) triangle[i] = patch->row[mesh->corner[t][i]];
        for (int i = 0; i < 3; i++)
            if (mesh->across[t][i] == PLM_NO_TRIANGLE || state[mesh->across[t][i]] == PLM_TRIANGLE_OUT)
                lean_outward(draft, triangle, i);
    }
    return PLM_OK;
}

/* ---- Seams ---------------------------------------------------------------------------------------------------- */

/** A set of directed sides, by open addressing; keys are never 0 as the two ends differ. */
typedef struct side_set {
    size_t mask;
    uint64_t *key;
} side_set;

static uint64_t side_key(uint32_t from, uint32_t to)
{
    return (uint64_t)from << 32 | to;
}

static size_t slot_of(const side_set *set, uint64_t key)
{
    size_t at = (size_t)((key * 0x9e3779b97f4a7c15u) >> 20) & set->mask;
    while (set->key[at] && set->key[at] != key) at = (at + 1) & set->mask;
    return at;
}

static bool has_side(const side_set *set, uint32_t from, uint32_t to)
{
    return set->key[slot_of(set, side_key(from, to))] != 0;
}

static void add_sides(side_set *set, const uint32_t corner[3])
{
    for (int i = 0; i < 3; i++) {
        const uint64_t key = side_key(corner[i], corner[(i + 1) % 3]);
        set->key[slot_of(set, key)] = key;
    }
}

/* Closes loops of free sides that are a few sides long by a fan from their first corner. */
static plm_status close_gaps(plm_leaf_draft *draft, size_t first, side_set *set, plm_error *error)
{
    enum { LONGEST = 8 };
    uint32_t *next = plm_alloc(draft->point_count, sizeof *next, error); /* along free sides, gaps on their left */
    if (!next) return PLM_E_MEMORY;
    plm_status status = PLM_OK;
    for (size_t i = 0; i < draft->point_count; i++) next[i] = PLM_NO_ROW;
    for (size_t t = first; t < draft->count; t++)
        for (int i = 0; i < 3; i++) {
            const uint32_t a = draft->triangle[t][i], b = draft->triangle[t][(i + 1) % 3];
            if (!has_side(set, b, a)) next[b] = next[b] == PLM_NO_ROW ? a : next[b];
        }
    for (uint32_t start = 0; start < draft->point_count && status == PLM_OK; start++) {
        uint32_t loop[LONGEST], at = start;
        int length = 0;
        while (length < LONGEST && at != PLM_NO_ROW) {
            loop[length++] = at;
            at = next[at];
            if (at == start) break;
        }
        if (at != start || length < 3) continue;
        status = make_room(draft, LONGEST, error);
        for (int i = 1; status == PLM_OK && i + 1 < length; i++) {
            const uint32_t fan[3] = {loop[0], loop[i], loop[i + 1]};
            memcpy(draft->triangle[draft->count++], fan, sizeof fan);
        }
        for (int i = 0; i < length; i++) next[loop[i]] = PLM_NO_ROW;
    }
    plm_free(next);
    return status;
}

plm_status plm_leaf_draft_mend(plm_leaf_draft *draft, size_t first, plm_error *error)
{
    size_t slots = 64;
    while (slots < 8 * (draft->count - first)) slots *= 2;
    side_set set = {slots - 1, plm_alloc_zero(slots, sizeof *set.key, error)};
    if (!set.key) return PLM_E_MEMORY;
    size_t kept = first;
    for (size_t t = first; t < draft->count; t++) {
        const uint32_t corner[3] = {draft->triangle[t][0], draft->triangle[t][1], draft->triangle[t][2]};
        if (has_side(&set, corner[0], corner[1]) || has_side(&set, corner[1], corner[2]) ||
            has_side(&set, corner[2], corner[0]))
            continue;
        add_sides(&set, corner);
        memcpy(draft->triangle[kept++], corner, sizeof corner);
    }
    draft->count = kept;
    const plm_status status = close_gaps(draft, first, &set, error);
    plm_free(set.key);
    return status;
}

/* ---- The finished mesh ---------------------------------------------------------------------------------------- */

static plm_status number_vertices(const plm_leaf_draft *draft, plm_mesh *mesh, uint32_t *row_of, plm_error *error)
{
    uint32_t *number = plm_alloc(draft->point_count, sizeof *number, error);
    if (!number) return PLM_E_MEMORY;
    memset(number, 0xff, draft->point_count * sizeof *number);
    mesh->vertex_count = 0;
    for (size_t t = 0; t < draft->count; t++)
        for (int i = 0; i < 3; i++) {
            const uint32_t row = draft->triangle[t][i];
            if (number[row] == PLM_NO_ROW) {
                number[row] = (uint32_t)mesh->vertex_count;
                row_of[mesh->vertex_count] = row;
                memcpy(mesh->vertex[mesh->vertex_count++], draft->place[row], sizeof *mesh->vertex);
            }
            mesh->triangle[t][i] = number[row];
        }
    plm_free(number);
    return PLM_OK;
}

/* Moves the rim by distance along the mean outward direction of its sides. */
static void move_rim(const plm_leaf_draft *draft, const uint32_t *row_of, double distance, plm_mesh *mesh)
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double out[3];
        memcpy(out, draft->outward[row_of[v]], sizeof out);
        const bool is_rim = plm_normalise(out) > 0;
        for (int i = 0; i < 3; i++) mesh->vertex[v][i] = draft->place[row_of[v]][i] + (is_rim ? distance * out[i] : 0);
    }
}

/* Area of the triangles that touch the rim: what moving it changes. */
static double rim_area(const plm_leaf_draft *draft, const plm_mesh *mesh)
{
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        bool touches = false;
        for (int i = 0; i < 3; i++) {
            const double *out = draft->outward[draft->triangle[t][i]];
            touches = touches || out[0] != 0 || out[1] != 0 || out[2] != 0;
        }
        if (!touches) continue;
        const double *corner[3];
        double a[3], b[3], normal[3];
        for (int i = 0; i < 3; i++) corner[i] = mesh->vertex[mesh->triangle[t][i]];
        for (int i = 0; i < 3; i++) {
            a[i] = corner[1][i] - corner[0][i];
            b[i] = corner[2][i] - corner[0][i];
        }
        plm_cross(a, b, normal);
        sum += 0.5 * plm_norm(normal);
    }
    return sum;
}

plm_status plm_leaf_draft_finish(const plm_leaf_draft *draft, double area, double furthest, plm_mesh *mesh,
                                 double *drawn, plm_error *error)
{
    plm_mesh made = {0};
    double before = 0;
    uint32_t *row_of = plm_alloc(draft->point_count, sizeof *row_of, error);
    plm_status status = row_of ? plm_mesh_create(draft->point_count, draft->count, &made, error) : PLM_E_MEMORY;
    if (status == PLM_OK) status = number_vertices(draft, &made, row_of, error);
    if (status == PLM_OK) status = plm_mesh_area(&made, &before, error);
    if (status == PLM_OK) {
        /* The area grows nearly in proportion: one step of known length gives the step that is wanted. */
        const double step = area >= before ? 0.5 * furthest : -0.5 * furthest;
        const double at_rim = rim_area(draft, &made);
        move_rim(draft, row_of, step, &made);
        const double grown = (rim_area(draft, &made) - at_rim) / step;
        const double wanted = grown > 0 ? (area - before) / grown : 0;
        move_rim(draft, row_of, fmax(-furthest, fmin(furthest, wanted)), &made);
    }
    plm_free(row_of);
    if (status == PLM_OK) {
        *mesh = made;
        *drawn = before;
    } else {
        plm_mesh_free(&made);
    }
    return status;
}
