/* io/image_write.c: pictures as PNG. libpng's long jumps end in write_rows, where nothing is left to free. */
#include "io/columns.h"

#include <png.h>
#include <stdio.h>

/** Where libpng's bytes and complaints go. */
typedef struct sink {
    plm_output *output;
    plm_status status;
    plm_error *error;
} sink;

static void take_bytes(png_structp png, png_bytep bytes, size_t count)
{
    sink *s = png_get_io_ptr(png);
    s->status = plm_output_write(s->output, bytes, count, s->error);
    if (s->status != PLM_OK) png_longjmp(png, 1);
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

static void take_complaint(png_structp png, png_const_charp text)
{
    sink *s = png_get_error_ptr(png);
    if (s->status == PLM_OK) s->status = plm_fail(s->error, PLM_E_LIBRARY, "libpng: %s", text);
    png_longjmp(png, 1);
}

static void ignore_warning(png_structp png, png_const_charp text)
{
    (void)png, (void)text;
}

static png_voidp seam_alloc(png_structp png, png_alloc_size_t size)
{
    (void)png;
    return plm_alloc(size, 1, NULL);
}

static void seam_free(png_structp png, png_voidp block)
{
    (void)png;
    plm_free(block);
}

/* False where libpng jumped out. */
static bool write_rows(png_structp png, png_infop info, const plm_image *image)
{
    if (setjmp(png_jmpbuf(png))) return false;
    const size_t row_bytes = (size_t)image->width * (size_t)image->channels * (size_t)image->bits / 8;
    png_set_IHDR(png, info, (png_uint_32)image->width, (png_uint_32)image->height, image->bits,
                 image->channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_filter(png, 0, PNG_FILTER_SUB);
    png_set_compression_level(png, 5);
    png_write_info(png, info);
    if (image->bits == 16 && plm_host_is_little()) png_set_swap(png);
    for (int row = 0; row < image->height; row++)
        png_write_row(png, (png_const_bytep)image->pixels + (size_t)row * row_bytes);
    png_write_end(png, NULL);
    return true;
}

static plm_status encode(const plm_image *image, plm_output *output, plm_error *error)
{
    sink s = {.output = output, .error = error};
    png_structp png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &s, take_complaint, ignore_warning, NULL,
                                                seam_alloc, seam_free);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info) {
        png_destroy_write_struct(&png, NULL);
        return plm_fail(error, PLM_E_MEMORY, "out of memory: libpng could not begin");
    }
    png_set_write_fn(png, &s, take_bytes, flush_nothing);
    if (!write_rows(png, info, image) && s.status == PLM_OK)
        s.status = plm_fail(error, PLM_E_LIBRARY, "libpng gave up without a reason");
    png_destroy_write_struct(&png, &info);
    return s.status;
}

plm_status plm_image_write_png(const char *path, const plm_image *image, plm_error *error)
{
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = encode(image, output, error);
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}
