/* hand/calibration_folder.h - the folder of calibrations in the user's configuration: one file per
 * person and hand. [main] */
#ifndef MAROTTE_HAND_CALIBRATION_FOLDER_H
#define MAROTTE_HAND_CALIBRATION_FOLDER_H
#include "hand/calibration_file.h"

/* Returns the path FOLDER/NAME.json; for a bare hand FOLDER/NAME, INPUT.json, so that the
 * calibrations of a person's glove and bare hand are separate files. name: 1 to 63 bytes, without
 * '/' and control characters, not beginning with '.'. Creates the folder. The caller frees
 * `out_path`. */
CHECKED mrt_result calibration_folder_place(char **out_path, const char *name, const char *input,
                                            error *err);

/* Finds the newest calibration of that side and input (calibration_file): by date, then by name.
 * MRT_OK: found; the caller finishes it and frees `out_path`. MRT_END: none. Unreadable files are
 * skipped; `out_note` names the first of them ("": none). */
CHECKED mrt_result calibration_folder_newest(calibration_file *out, char **out_path, uint32_t side,
                                             const char *input, error *out_note, error *err);

/* An entry of a list to choose from. */
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
/* Lists the calibrations of both sides. A missing folder counts as empty. Unreadable files are
 * skipped; `out_note` names the first of them. */
CHECKED mrt_result calibration_folder_list(calibration_list *out, error *out_note, error *err);
void calibration_list_finish(calibration_list *list); /* accepts a zeroed struct */

/* ---- replacing a stored calibration by a new one ---- */

/* Reads the calibration at `path`; the caller finishes it. If there is none, it is empty. Fails if
 * the file is not a calibration. */
CHECKED mrt_result calibration_keep_old(calibration_file *out, const char *path, error *err);
/* Fails if the old calibration is of the other hand, or of another kind of input. path: of the old
 * one. */
CHECKED mrt_result calibration_keep_fits(const calibration_file *made, const calibration_file *old,
                                         const char *path, error *err);
/* Sets the name, the current date and the hand length. NULL, "" and 0: those of the old one. */
void calibration_keep_sign(calibration_file *made, const calibration_file *old, const char *name,
                           double hand_length_mm);
CHECKED mrt_result calibration_keep_write(calibration_file *made, const calibration_file *old,
                                          const char *path, error *err);

#endif
