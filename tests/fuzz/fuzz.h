/* tests/fuzz/fuzz.h: what the fuzz targets share.
 *
 * | function        | target        |
 * |-----------------|---------------|
 * | PLY reader      | fuzz_ply.c    |
 * | mesh readers    | fuzz_mesh.c   |
 * | PCD reader, LZF | fuzz_pcd.c    |
 * | LAS reader      | fuzz_las.c    |
 * | text reader     | fuzz_text.c   |
 * | number parser   | fuzz_number.c |
 *
 * clang's libFuzzer drives them (preset `fuzz`); replay.c runs the corpus and tests/hostile through them in the ordinary
 * tests. */
#ifndef PLANTIMETER_FUZZ_H
#define PLANTIMETER_FUZZ_H

#include "io/readers.h"

/** libFuzzer's entry. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/** Reads data with several options; stops the process where an accepted cloud breaks a promise of io/io.h. */
void fuzz_reader(plm_reader *read, plm_format format, const uint8_t *data, size_t size);

#endif
