/* reports/thumbnail.c: a picture made smaller: libpng in, libjpeg out. */
#include "reports/thumbnail.h"

#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h> /* after stdio.h, which it needs */

enum { QUALITY = 82, LARGEST = 20000 };

/** Pixels, three bytes each, rows from the top. */
typedef struct pixels {
    int width, height;
    unsigned char *rgb;
} pixels;

static plm_status read_png(const char *path, pixels *read, plm_error *error)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&image, path))
        return plm_fail(error, PLM_E_READ, "%s: %s", path, image.message);
    image.format = PNG_FORMAT_RGB;
    plm_status status = PLM_OK;
    read->rgb = NULL;
    if (image.width > LARGEST || image.height > LARGEST)
        status = plm_fail(error, PLM_E_FORMAT, "%s: a picture of %u x %u pixels", path, image.width, image.height);
    if (status == PLM_OK && !(read->rgb = plm_alloc(PNG_IMAGE_SIZE(image), 1, error))) status = PLM_E_MEMORY;
    if (status == PLM_OK && !png_image_finish_read(&image, NULL, read->rgb, 0, NULL))
        status = plm_fail(error, PLM_E_FORMAT, "%s: %s", path, image.message);
    read->width = (int)image.width;
    read->height = (int)image.height;
    png_image_free(&image);
    if (status != PLM_OK) plm_free(read->rgb);
    return status;
}

/* The mean of factor x factor pixels, of the columns left of width. In place. */
static void shrink(pixels *picture, int width, int factor)
{
    const int columns = width / factor, rows = picture->height / factor;
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < columns; x++)
            for (int k = 0; k < 3; k++) {
                int sum = 0;
                for (int j = 0; j < factor; j++)
                    for (int i = 0; i < factor; i++)
                        sum += picture->rgb[3 * ((y * factor + j) * picture->width + x * factor + i) + k];
                /* Never ahead of what is still to be read: rows and columns only get fewer. */
                picture->rgb[3 * (y * columns + x) + k] =
                    (unsigned char)((sum + factor * factor / 2) / (factor * factor));
            }
    picture->width = columns;
    picture->height = rows;
}

/** libjpeg's errors come back by a jump. */
typedef struct jpeg_trouble {
    struct jpeg_error_mgr manager; /* first: libjpeg hands out its address */
    jmp_buf back;
} jpeg_trouble;

static void jump_back(j_common_ptr info)
{
    longjmp(((jpeg_trouble *)(void *)info->err)->back, 1);
}

static void say_nothing(j_common_ptr info)
{
    (void)info;
}

/* made and size come from malloc: libjpeg's own. */
static bool compress(const pixels *picture, unsigned char **made, unsigned long *size)
{
    struct jpeg_compress_struct jpeg;
    jpeg_trouble trouble;
    memset(&jpeg, 0, sizeof jpeg);
    jpeg.err = jpeg_std_error(&trouble.manager);
    trouble.manager.error_exit = jump_back;
    trouble.manager.output_message = say_nothing;
    if (setjmp(trouble.back)) {
        jpeg_destroy_compress(&jpeg);
        return false;
    }
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, made, size);
    jpeg.image_width = (JDIMENSION)picture->width;
    jpeg.image_height = (JDIMENSION)picture->height;
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, QUALITY, TRUE);
    jpeg_start_compress(&jpeg, TRUE);
    while (jpeg.next_scanline < jpeg.image_height) {
        JSAMPROW row = picture->rgb + (size_t)3 * jpeg.next_scanline * (size_t)picture->width;
        jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    return true;
}

plm_status plm_thumbnail(const char *png_path, double share, int factor, unsigned char **bytes, size_t *size,
                         plm_error *error)
{
    pixels picture = {0};
    plm_status status = read_png(png_path, &picture, error);
    if (status != PLM_OK) return status;
    const int width = (int)(share * picture.width);
    if (width < factor || picture.height < factor) {
        plm_free(picture.rgb);
        return plm_fail(error, PLM_E_FORMAT, "%s: too small a picture", png_path);
    }
    shrink(&picture, width, factor);
    unsigned char *made = NULL;
    unsigned long made_size = 0;
    if (!compress(&picture, &made, &made_size)) status = plm_fail(error, PLM_E_LIBRARY, "%s: libjpeg failed", png_path);
    if (status == PLM_OK && !(*bytes = plm_alloc(made_size, 1, error))) status = PLM_E_MEMORY;
    if (status == PLM_OK) {
        memcpy(*bytes, made, made_size);
        *size = made_size;
    }
    free(made);
    plm_free(picture.rgb);
    return status;
}
