/* hand/calibration_file.h - a person's calibration of one glove as a JSON file: for each sensor its
 * table, the source of the table, the observed range, and the residual. Leaves out making it
 * (guide.h, virtualhand.h) and its folder (calibration_folder.h). [main]
 *
 *   { "marotte_calibration": 1, "name": "anna", "date": "2026-03-01T18:00:00Z", "hand": "right",
 *     "sensor_count": 18, "hand_length_mm": 182,          // wrist to middle fingertip; optional
 *     "input": "camera",                                  // for a bare hand: raw is rad; optional
 *     "sensors": { "index.mpj": {                         // names as in logs (sensor.h)
 *         "source": "measured",                           // calibration_source
 *         "points": [[62, 0], [148, 1.571]],              // 2..16 of (raw, rad), raw ascending
 *         "neutral_rad": 0.42,                            // relaxed, ready to talk
 *         "raw_range": [58, 150], "rad_range": [-0.07, 1.6],  // observed; optional
 *         "residual_rad": 0.03,                           // optional
 *         "cross_talk": { "middle.mpj": 0.21 } } } }      // rad of others per rad of this sensor
 *
 * Sensors that the glove lacks have no entry, and neither do sensors of a bare hand that are used
 * unchanged. Unknown keys are kept. */
#ifndef MAROTTE_HAND_CALIBRATION_FILE_H
#define MAROTTE_HAND_CALIBRATION_FILE_H
#include "hand/hand.h"

enum { CALIBRATION_NAME = 64, CALIBRATION_DATE = 24, CALIBRATION_NOTE = 2048 };
enum { CALIBRATION_FILE_CAP = 1 << 20 }; /* bytes */

typedef enum calibration_source {
    CALIBRATION_SHIPPED = 0, /* all values are shipped defaults */
    CALIBRATION_ZEROED,      /* the zero was measured, the gain is the shipped one */
    CALIBRATION_MEASURED,
    CALIBRATION_IMPORTED, /* from another program's calibration */
    CALIBRATION_SOURCES
} calibration_source;
extern const char *const calibration_source_name[CALIBRATION_SOURCES]; /* "shipped" ... */

typedef struct calibration_sensor {
    hand_table table; /* count 0: the glove does not have this sensor */
    calibration_source source;
    float neutral_rad;
    bool has_range, has_residual;
    float raw_range[2], rad_range[2]; /* minimum, maximum */
    float residual_rad;           /* RMS of the readings of known poses that are held repeatedly */
    float cross_talk[MRT_ANGLES]; /* rad of the other sensors per rad of this one; 0: none or
                                     unknown */
} calibration_sensor;

typedef struct calibration_file {
    char name[CALIBRATION_NAME]; /* of the person, or "" */
    char date[CALIBRATION_DATE]; /* "2026-03-01T18:00:00Z", or "" */
    uint32_t side;               /* MRT_LEFT, MRT_RIGHT */
    char input[HAND_INPUT];      /* as in hand_calibration */
    double hand_length_mm;       /* 0: unknown */
    calibration_sensor sensor[MRT_ANGLES];
    char note[CALIBRATION_NOTE]; /* messages about parts that were not understood, one per line; "":
                                    none */
    void *document;              /* the JSON that was read, to keep unknown keys; owned; or NULL */
} calibration_file;

/* Makes an empty calibration without sensors. Without a document it needs no finish. */
void calibration_file_init(calibration_file *out, uint32_t side);
/* `name` is the name of the file, for messages: "NAME: $.sensors["index.mpj"].points[1]: expected
 * ...". On failure `out` needs no finish. */
CHECKED mrt_result calibration_file_parse(calibration_file *out, const void *bytes, size_t size,
                                          const char *name, error *err);
CHECKED mrt_result calibration_file_read(calibration_file *out, const char *path, error *err);
void calibration_file_finish(calibration_file *file); /* accepts NULL and a zeroed struct */

/* Writes the whole file; on failure the previous file is kept. */
CHECKED mrt_result calibration_file_write(const calibration_file *file, const char *path,
                                          error *err);
/* Returns the text of the file, 0-ended; the caller frees it. NULL: no memory. */
char *calibration_file_text(const calibration_file *file);

uint32_t calibration_file_sensor_count(const calibration_file *file);
/* Fills missing sensors: for a glove with the shipped defaults, for a bare hand with its angles
 * unchanged. */
void calibration_file_use(const calibration_file *file, hand_calibration *out);

/* Appends a line. Does nothing if the note is full. */
__attribute__((format(printf, 2, 3))) void calibration_file_note(calibration_file *file,
                                                                 const char *format, ...);

/* Returns the table rad = gain * (raw - zero) + rad_at_zero. It ends 15 degrees beyond the clinical
 * range of the joint (sensor.h), where the angle is constant: the slopes at its ends are 0. gain:
 * not 0. */
hand_table calibration_line(int sensor, double gain, double zero, double rad_at_zero);

#endif
