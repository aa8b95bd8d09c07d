/* tests/fuzz/fuzz_mesh.c: the readers of meshes, PLY and OBJ. */
#include "fuzz.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void require(bool holds, const char *what)
{
    if (holds) return;
    fprintf(stderr, "broken: %s\n", what);
    abort();
}

static void check(const plm_mesh *mesh, const uint8_t *label)
{
    require(mesh->triangle_count > 0, "a mesh has faces");
    for (size_t k = 0; k < mesh->triangle_count; k++) {
        for (int i = 0; i < 3; i++) require(mesh->triangle[k][i] < mesh->vertex_count, "corners are vertices");
        if (label) require(label[k] < PLM_LABEL_COUNT, "labels are classes");
        if (mesh->face_organ) require(mesh->face_organ[k] >= -1, "organs are numbered from 0, or -1");
    }
    for (size_t k = 0; k < mesh->vertex_count; k++)
        for (int i = 0; i < 3; i++) require(isfinite(mesh->vertex[k][i]) != 0, "vertices are finite");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *exact = malloc(size ? size : 1), *label = NULL; /* a block of its own, so that a sanitizer sees its end */
    plm_error error = {0};
    plm_mesh mesh = {0};
    if (!exact) return 0;
    memcpy(exact, data, size);
    const plm_status status = plm_mesh_parse(exact, size, "fuzz", &mesh, &label, &error);
    if (status == PLM_OK) {
        check(&mesh, label);
        plm_mesh_free(&mesh);
        plm_free(label);
    } else {
        require(error.status == status && error.message[0], "a failure has a message");
        require(!mesh.vertex && !label, "a failure leaves the outputs alone");
    }
    free(exact);
    return 0;
}
