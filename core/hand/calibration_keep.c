#include "hand/calibration_keep.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

mrt_result calibration_keep_old(calibration_file *out, const char *path, error *err)
{
    calibration_file_init(out, MRT_RIGHT);
    if (access(path, F_OK) != 0)
        return MRT_OK;
    mrt_result result = calibration_file_read(out, path, err);
    if (result < 0)
        error_prefix(err, "not overwritten, since it is no calibration (choose another name)");
    return result;
}

void calibration_keep_sign(calibration_file *made, const calibration_file *old, const char *name,
                           double hand_length_mm)
{
    bool has_name = name && name[0];
    (void)snprintf(made->name, sizeof made->name, "%s", has_name ? name : old->name);
    if (hand_length_mm > 0)
        made->hand_length_mm = hand_length_mm;
    else if (!(made->hand_length_mm > 0))
        made->hand_length_mm = old->hand_length_mm;
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc))
        (void)strftime(made->date, sizeof made->date, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

mrt_result calibration_keep_write(calibration_file *made, const calibration_file *old,
                                  const char *path, error *err)
{
    void *own = made->document;
    made->document = old->document;
    mrt_result result = calibration_file_write(made, path, err);
    made->document = own;
    return result;
}
