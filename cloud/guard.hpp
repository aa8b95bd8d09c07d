/* cloud/guard.hpp: the one place where C++ exceptions stop. Every adapter wraps its whole body in plm_guard. */
#ifndef PLANTIMETER_CLOUD_GUARD_HPP
#define PLANTIMETER_CLOUD_GUARD_HPP

#include "cloud/cloud.h"

#include <exception>
#include <new>

/** Runs body, which returns a plm_status, and turns what it throws into one: bad_alloc into PLM_E_MEMORY, all else into
 * PLM_E_LIBRARY with the exception's text behind what ("CGAL alpha shape"). */
template <class Body> plm_status plm_guard(plm_error *error, const char *what, Body body) noexcept
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return plm_fail(error, PLM_E_MEMORY, "out of memory in %s", what);
    } catch (const std::exception &exception) {
        return plm_fail(error, PLM_E_LIBRARY, "%s failed: %s", what, exception.what());
    } catch (...) {
        return plm_fail(error, PLM_E_LIBRARY, "%s failed for a reason that it does not tell", what);
    }
}

#endif
