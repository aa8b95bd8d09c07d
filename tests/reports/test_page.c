/* The parts of report.html: escaping, base64, views, pictures made small. */
#include "support/test.h"

#include "reports/base64.h"
#include "reports/canvas.h"
#include "reports/html.h"
#include "reports/thumbnail.h"
#include "reports/view_file.h"

#include <jansson.h>

static void base64_is_that_of_rfc_4648(void **unused)
{
    (void)unused;
    static const char *const expected[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
    for (size_t size = 0; size < COUNT(expected); size++) {
        plm_error error = {0};
        char *text = plm_base64("foobar", size, &error);
        assert_non_null(text);
        assert_string_equal(text, expected[size]);
        plm_free(text);
    }
    plm_error error = {0};
    const unsigned char all_bits[] = {0xff, 0xef, 0xbe};
    char *text = plm_base64(all_bits, sizeof all_bits, &error);
    assert_string_equal(text, "/+++");
    plm_free(text);
}

static void text_of_the_user_cannot_become_markup(void **unused)
{
    (void)unused;
    plm_error error = {0};
    char *folder = test_make_folder(), path[512], found[256] = "";
    snprintf(path, sizeof path, "%s/page.html", folder);
    plm_html page = {.error = &error};
    assert_ok(plm_output_open(path, &page.output, &error));
    plm_html_text(&page, "<script>alert('a & \"b\"')</script>\x01");
    plm_html_print(&page, "|%d", 3);
    assert_ok(page.status);
    assert_ok(plm_output_close(page.output, true, &error));
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_true(fread(found, 1, sizeof found - 1, file) > 0);
    fclose(file);
    assert_string_equal(found, "&lt;script&gt;alert(&#39;a &amp; &quot;b&quot;&#39;)&lt;/script&gt;?|3");
    test_remove_folder(folder);
}

static void a_thumbnail_is_a_jpeg_of_the_left_part(void **unused)
{
    (void)unused;
    plm_error error = {0};
    char *folder = test_make_folder(), path[512];
    snprintf(path, sizeof path, "%s/picture.png", folder);
    plm_canvas canvas;
    assert_ok(plm_canvas_create(90, 60, (plm_rgb){255, 255, 255}, &canvas, &error));
    plm_canvas_box(&canvas, 10, 10, 30, 30, (plm_rgb){0, 114, 178});
    assert_ok(plm_canvas_write_png(&canvas, path, &error));
    plm_canvas_free(&canvas);
    unsigned char *bytes = NULL;
    size_t size = 0;
    assert_ok(plm_thumbnail(path, 2.0 / 3 + 1e-9, 3, &bytes, &size, &error));
    assert_true(size > 100 && bytes[0] == 0xff && bytes[1] == 0xd8);
    bool found = false; /* the frame's header: height 20, width 20 */
    for (size_t i = 0; i + 9 < size; i++)
        if (bytes[i] == 0xff && bytes[i + 1] == 0xc0)
            found = bytes[i + 5] == 0 && bytes[i + 6] == 20 && bytes[i + 7] == 0 && bytes[i + 8] == 20;
    assert_true(found);
    plm_free(bytes);
    assert_int_equal(plm_thumbnail(path, 0.01, 3, &bytes, &size, &error), PLM_E_FORMAT);
    snprintf(path, sizeof path, "%s/nowhere.png", folder);
    assert_int_equal(plm_thumbnail(path, 1, 3, &bytes, &size, &error), PLM_E_READ);
    test_remove_folder(folder);
}

/* Fifty times as many points as are wanted, and one leaf of a known square. */
static void a_view_holds_at_most_the_points_asked_for_within_a_step_of_their_place(void **unused)
{
    (void)unused;
    enum { POINTS = 50000, WANTED = 1000 };
    plm_error error = {0};
    plm_measurement plant = {0};
    assert_ok(plm_cloud_create(POINTS, PLM_HAS_LABEL | PLM_HAS_ORGAN, &plant.cloud, &error));
    for (size_t i = 0; i < POINTS; i++) {
        plant.cloud.xyz[i][0] = (float)(i % 250) * 0.001f;
        plant.cloud.xyz[i][1] = (float)(i / 250) * 0.001f;
        plant.cloud.xyz[i][2] = i % 2 ? 0.0f : 0.1f;
        plant.cloud.label[i] = PLM_LABEL_LEAF;
        plant.cloud.organ[i] = (int32_t)(i % 3);
    }
    plant.cloud.origin[0] = 500000; /* only offsets are shown */
    char *folder = test_make_folder(), path[512];
    snprintf(path, sizeof path, "%s/plant.view.json", folder);
    const plm_view_limits limits = {.points = WANTED};
    assert_ok(plm_write_view(path, "a\"b", &plant, &limits, &error));
    json_t *view = json_load_file(path, 0, NULL);
    assert_non_null(view);
    assert_string_equal(json_string_value(json_object_get(view, "plant_id")), "a\"b");
    const json_t *points = json_object_get(view, "points");
    const json_int_t count = json_integer_value(json_object_get(points, "count"));
    assert_true(count > WANTED / 2 && count <= WANTED);
    assert_int_equal(json_integer_value(json_object_get(points, "of")), POINTS);
    assert_int_equal(json_array_size(json_object_get(view, "organs")), 3);
    assert_near(json_number_value(json_object_get(view, "step")), 0.249 / 65535,
                1e-7); /* the longest side is nearly seen whole */
    const char *xyz = json_string_value(json_object_get(points, "xyz"));
    assert_int_equal(strlen(xyz), (size_t)((count * 6 + 2) / 3 * 4));
    assert_true(json_is_null(json_object_get(view, "leaves")));
    json_decref(view);
    plm_cloud_free(&plant.cloud);
    test_remove_folder(folder);
}

/* Places that are no numbers come from plants of which nothing could be drawn. */
static void what_has_no_place_is_not_drawn(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_canvas canvas;
    const plm_rgb white = {255, 255, 255}, ink = {0, 0, 0};
    const plm_lettering lettering = {.size = 9, .colour = ink, .has_halo = true};
    assert_ok(plm_canvas_create(90, 60, white, &canvas, &error));
    const double nowhere[] = {NAN, INFINITY, -INFINITY, 1e300};
    for (size_t k = 0; k < COUNT(nowhere); k++) {
        plm_canvas_text(&canvas, nowhere[k], 30, "12 mm", &lettering);
        plm_canvas_text(&canvas, 30, nowhere[k], "12 mm", &lettering);
        plm_canvas_line(&canvas, 10, 10, 10, nowhere[k], 2, ink);
    }
    for (size_t i = 0; i < (size_t)(90 * 60); i++) assert_memory_equal(&canvas.pixel[i], &white, sizeof white);
    plm_canvas_free(&canvas);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(base64_is_that_of_rfc_4648),
        cmocka_unit_test(text_of_the_user_cannot_become_markup),
        cmocka_unit_test(a_thumbnail_is_a_jpeg_of_the_left_part),
        cmocka_unit_test(a_view_holds_at_most_the_points_asked_for_within_a_step_of_their_place),
        cmocka_unit_test(what_has_no_place_is_not_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
