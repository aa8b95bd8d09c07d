/* reports/report.h: report.html, the one page of a run that people look at. Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_REPORT_H
#define PLANTIMETER_REPORTS_REPORT_H

#include "reports/html.h"
#include "reports/results.h"

/** How many plants get their whole picture and a 3D view where nobody says otherwise. */
enum { PLM_REPORT_VIEWS = 20 };

typedef struct plm_report_options {
    const char
        *validation; /**< folder that `validate` wrote; NULL: none, or the run's own where it holds agreement.csv */
    size_t views;    /**< the first so many plants with their whole picture and a 3D view; the others small pictures */
    bool plots;      /**< draw folder/plots/overview.svg first; the page shows it wherever it is there */
} plm_report_options;

/** Writes folder/report.html from what the folder holds: run.json, traits.csv, the plants' pictures and views; or, where there
 * is no run.json, from the validation alone. The page is complete in itself: no network, no other file. Same input, same
 * bytes. has_view: out, whether three.js was there when the program was built (else the page says that it was not).
 * PLM_E_READ, PLM_E_FORMAT, PLM_E_WRITE, PLM_E_MEMORY. A missing picture or view is left out. */
plm_status plm_report_write(const char *folder, const plm_report_options *options, bool *has_view, plm_error *error);

/* ---- The parts of the page --------------------------------------------------------------------------------------- */

/** The page under way. */
typedef struct plm_report {
    plm_html page;
    const char *folder;
    const plm_report_options *options;
    const plm_results *results;
    const json_t *root; /**< run.json, NULL where there is none */
} plm_report;

/** The table of plants, and the traits' meanings. */
void plm_report_summary(plm_report *report);
/** Picture, 3D view, traits, organs and warnings of each plant. */
void plm_report_cards(plm_report *report);
/** Statistics and plots of a validation's folder; nothing where it holds no agreement.csv. */
void plm_report_validation(plm_report *report, const char *folder);
/** Version, options, inputs with their checksums, what was run. */
void plm_report_provenance(plm_report *report);

/** A plot of folder/plots as an object: the pointer over a point names the plant. Nothing where it is not there. */
void plm_report_plot(plm_report *report, const char *folder, const char *name, const char *label);

/** Whether folder/name is there. */
bool plm_report_has(const char *folder, const char *name);

#endif
