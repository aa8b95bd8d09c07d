/* cloud/clock.c: deadlines on the steady clock, or on one that a test winds. */
#include "cloud/clock.h"

#include "cloud/cloud.h"

double plm_deadline_now(const plm_deadline *deadline)
{
    return deadline && deadline->clock ? deadline->clock(deadline->user) : plm_seconds_now();
}

bool plm_deadline_passed(const plm_deadline *deadline)
{
    return deadline && plm_deadline_now(deadline) > deadline->at;
}

plm_status plm_deadline_check(const plm_deadline *deadline, plm_error *error)
{
    return plm_deadline_passed(deadline) ? plm_fail(error, PLM_E_TIME, "the time budget is used up") : PLM_OK;
}
