/* simulate/ray_order.c: sorting rays by counting, a few nanoseconds a ray. */
#include "simulate/ray_order.h"

enum { CELLS = 64 };

/* The bits of a number below 64, each followed by a zero. */
static uint32_t spread_bits(uint32_t x)
{
    x = (x | x << 4) & 0x0f0f;
    x = (x | x << 2) & 0x3333;
    return (x | x << 1) & 0x5555;
}

static uint32_t cell_of(float place)
{
    const int cell = (int)(place * CELLS);
    return cell < 0 ? 0 : cell >= CELLS ? CELLS - 1 : (uint32_t)cell;
}

void plm_ray_order(const float *x, const float *y, size_t count, uint16_t *order)
{
    uint16_t cell[PLM_RAY_BATCH], begin[CELLS * CELLS + 1] = {0};
    for (size_t k = 0; k < count; k++) {
        cell[k] = (uint16_t)(spread_bits(cell_of(x[k])) | spread_bits(cell_of(y[k])) << 1);
        begin[cell[k] + 1]++;
    }
    for (int c = 0; c < CELLS * CELLS; c++) begin[c + 1] = (uint16_t)(begin[c + 1] + begin[c]);
    for (size_t k = 0; k < count; k++) order[begin[cell[k]]++] = (uint16_t)k;
}
