#include "face/rig/rig_edit_parts.h"

#include <stdlib.h>
#include <string.h>

static mrt_result check_index(const rig *r, uint32_t index, error *err)
{
    return index < r->proxy_count
               ? MRT_OK
               : error_set(err, MRT_ERR_ARGUMENT, "there is no ellipsoid %u", index);
}

static mrt_result check(const rig *r, const rig_proxy *proxy, error *err)
{
    if (proxy->bone >= r->bone_count)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no bone %u", proxy->bone);
    if (!rig_edit_is_place(proxy->centre) || !rig_edit_is_place(proxy->radii))
        return error_set(err, MRT_ERR_ARGUMENT, "the ellipsoid is too far away, or too large");
    if (!(proxy->radii.x > 0.0 && proxy->radii.y > 0.0 && proxy->radii.z > 0.0))
        return error_set(err, MRT_ERR_ARGUMENT, "an ellipsoid has three radii above 0");
    return MRT_OK;
}

/* A radius stays above 0. */
static double round_radius(double mm, double before)
{
    const double rounded = rig_edit_round_mm(mm, before);
    return rounded > 0.0 ? rounded : mm;
}

static rig_proxy rounded(const rig_proxy *proxy, const rig_proxy *before)
{
    rig_proxy out = *proxy;
    out.centre = rig_edit_round_place(proxy->centre, before->centre);
    out.radii = (vec3){round_radius(proxy->radii.x, before->radii.x),
                       round_radius(proxy->radii.y, before->radii.y),
                       round_radius(proxy->radii.z, before->radii.z)};
    out.source = before->source;
    return out;
}

mrt_result rig_edit_add_proxy(rig *r, const rig_proxy *proxy, uint32_t *out_index, error *err)
{
    mrt_result result = check(r, proxy, err);
    if (result < 0)
        return result;
    if (r->proxy_count >= RIG_EDIT_ENTRIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig has at most %d ellipsoids",
                         RIG_EDIT_ENTRIES_MAX);
    rig_proxy *grown = realloc(r->proxy, (r->proxy_count + 2u) * sizeof *grown);
    if (!grown)
        return rig_edit_no_memory(err);
    r->proxy = grown;
    r->proxy[r->proxy_count] = rounded(proxy, &(rig_proxy){.source = 0});
    *out_index = r->proxy_count;
    r->proxy_count += 1;
    return MRT_OK;
}

mrt_result rig_edit_remove_proxy(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_index(r, index, err);
    if (result < 0)
        return result;
    memmove(&r->proxy[index], &r->proxy[index + 1],
            (r->proxy_count - index - 1) * sizeof *r->proxy);
    r->proxy_count -= 1;
    return MRT_OK;
}

mrt_result rig_edit_set_proxy(rig *r, uint32_t index, const rig_proxy *proxy, error *err)
{
    mrt_result result = check_index(r, index, err);
    if (result >= 0)
        result = check(r, proxy, err);
    if (result < 0)
        return result;
    r->proxy[index] = rounded(proxy, &r->proxy[index]);
    return MRT_OK;
}
