/* reports/html.c: writing a page. */
#include "reports/html.h"

#include "reports/base64.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void plm_html_bytes(plm_html *page, const void *bytes, size_t size)
{
    if (page->status == PLM_OK) page->status = plm_output_write(page->output, bytes, size, page->error);
}

void plm_html_print(plm_html *page, const char *format, ...)
{
    char text[2048];
    va_list values;
    va_start(values, format);
    const int length = vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (page->status == PLM_OK && (length < 0 || (size_t)length >= sizeof text))
        page->status = plm_fail(page->error, PLM_E_ARGUMENT, "a piece of the page of %d bytes", length);
    if (page->status == PLM_OK) plm_html_bytes(page, text, (size_t)length);
}

void plm_html_text(plm_html *page, const char *text)
{
    for (const char *at = text; *at;) {
        const size_t plain =
            strcspn(at, "&<>\"'\x01\x02\x03\x04\x05\x06\x07\x08\x0b\x0c\x0e\x0f\x10\x11\x12\x13\x14\x15\x16"
                        "\x17\x18\x19\x1a\x1b\x1c\x1d\x1e\x1f\x7f");
        plm_html_bytes(page, at, plain);
        at += plain;
        if (*at) {
            const char *safe = *at == '&'    ? "&amp;"
                               : *at == '<'  ? "&lt;"
                               : *at == '>'  ? "&gt;"
                               : *at == '"'  ? "&quot;"
                               : *at == '\'' ? "&#39;"
                                             : "?";
            plm_html_bytes(page, safe, strlen(safe));
            at++;
        }
    }
}

void plm_html_data_uri(plm_html *page, const char *type, const void *bytes, size_t size)
{
    if (page->status != PLM_OK) return;
    char *text = plm_base64(bytes, size, page->error);
    if (!text) page->status = PLM_E_MEMORY;
    plm_html_print(page, "data:%s;base64,", type);
    if (text) plm_html_bytes(page, text, strlen(text));
    plm_free(text);
}
