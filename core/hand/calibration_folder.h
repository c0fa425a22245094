/* hand/calibration_folder.h - where calibrations are kept: a folder of the user's configuration,
 * one file a person and hand. [main] */
#ifndef MAROTTE_HAND_CALIBRATION_FOLDER_H
#define MAROTTE_HAND_CALIBRATION_FOLDER_H
#include "hand/calibration_file.h"

/* FOLDER/NAME.json; of a bare hand FOLDER/NAME, INPUT.json, so that a person's glove and her hand
 * before a camera are kept beside each other. The name: 1 to 63 bytes, none of them '/' or a
 * control character, not first a '.'. Makes the folder when it is not there. `out_path` is to be
 * freed. */
CHECKED mrt_result calibration_folder_place(char **out_path, const char *name, const char *input,
                                            error *err);

/* The newest calibration of that side and input (calibration_file), by its date, then by its name.
 * MRT_OK: there is one, to be finished; `out_path` is to be freed. MRT_END: there is none. Files
 * that cannot be read are left out, the first of them is named in `out_note` ("": all could be
 * read). */
CHECKED mrt_result calibration_folder_newest(calibration_file *out, char **out_path, uint32_t side,
                                             const char *input, error *out_note, error *err);

/* What there is to choose from. */
typedef struct calibration_entry {
    char *path;
    char label[CALIBRATION_NAME + CALIBRATION_DATE]; /* "anna, 2026-03-01" */
    char date[CALIBRATION_DATE];
    uint32_t side;
    char input[HAND_INPUT];
} calibration_entry;
typedef struct calibration_list {
    calibration_entry *entry; /* the newest first */
    uint32_t count;
} calibration_list;
/* Of both sides. No folder: none. Files that cannot be read are left out, the first of them is
 * named in `out_note`. */
CHECKED mrt_result calibration_folder_list(calibration_list *out, error *out_note, error *err);
void calibration_list_finish(calibration_list *list); /* zeroed is fine */

/* ---- a calibration that was made takes the place of one that was kept ---- */

/* What stands at `path` now, to be finished; empty: nothing. An error: it is no calibration. */
CHECKED mrt_result calibration_keep_old(calibration_file *out, const char *path, error *err);
/* Of the other hand, or of a glove where the old one is of a bare hand: an error. `path`: of the
 * old one. */
CHECKED mrt_result calibration_keep_fits(const calibration_file *made, const calibration_file *old,
                                         const char *path, error *err);
/* Name, date of now and hand length; NULL, "" and 0: the old one's. */
void calibration_keep_sign(calibration_file *made, const calibration_file *old, const char *name,
                           double hand_length_mm);
CHECKED mrt_result calibration_keep_write(calibration_file *made, const calibration_file *old,
                                          const char *path, error *err);

#endif
