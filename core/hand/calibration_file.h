/* hand/calibration_file.h - a person's calibration of one glove, as it is kept: a JSON file with a
 * table per sensor, where that comes from, what was seen, and how well it fits. Leaves out how it
 * is made (guide.h, virtualhand.h) and where it is kept (calibration_folder.h). [main]
 *
 *   { "marotte_calibration": 1, "name": "anna", "date": "2026-03-01T18:00:00Z", "hand": "right",
 *     "sensor_count": 18, "hand_length_mm": 182,          // wrist to middle fingertip; optional
 *     "input": "camera",                                  // a bare hand's: raw is rad; optional
 *     "sensors": { "index.mpj": {                         // names as in logs (sensor.h)
 *         "source": "measured",                           // calibration_source
 *         "points": [[62, 0], [148, 1.571]],              // 2..16 of (raw, rad), raw ascending
 *         "neutral_rad": 0.42,                            // relaxed, ready to talk
 *         "raw_range": [58, 150], "rad_range": [-0.07, 1.6],  // seen; optional
 *         "residual_rad": 0.03,                           // optional
 *         "cross_talk": { "middle.mpj": 0.21 } } } }      // rad that those move per rad of this
 *
 * A sensor that the glove lacks has no entry, nor one of a bare hand that is taken as it is. Keys
 * that this version does not know are kept. */
#ifndef MAROTTE_HAND_CALIBRATION_FILE_H
#define MAROTTE_HAND_CALIBRATION_FILE_H
#include "hand/hand.h"

enum { CALIBRATION_NAME = 64, CALIBRATION_DATE = 24, CALIBRATION_NOTE = 2048 };
enum { CALIBRATION_FILE_CAP = 1 << 20 }; /* bytes */

typedef enum calibration_source {
    CALIBRATION_SHIPPED = 0, /* nothing of it is this person's */
    CALIBRATION_ZEROED,      /* the zero was measured, the gain is shipped */
    CALIBRATION_MEASURED,
    CALIBRATION_IMPORTED, /* from another program's calibration */
    CALIBRATION_SOURCES
} calibration_source;
extern const char *const calibration_source_name[CALIBRATION_SOURCES]; /* "shipped" ... */

typedef struct calibration_sensor {
    hand_table table; /* count 0: the glove lacks this sensor */
    calibration_source source;
    float neutral_rad;
    bool has_range, has_residual;
    float raw_range[2], rad_range[2]; /* least, greatest */
    float residual_rad;               /* RMS of what known poses are read as, held repeatedly */
    float cross_talk[MRT_ANGLES];     /* rad of those per rad of this; 0: none or not known */
} calibration_sensor;

typedef struct calibration_file {
    char name[CALIBRATION_NAME]; /* the person, or "" */
    char date[CALIBRATION_DATE]; /* "2026-03-01T18:00:00Z", or "" */
    uint32_t side;               /* MRT_LEFT, MRT_RIGHT */
    char input[HAND_INPUT];      /* as in hand_calibration */
    double hand_length_mm;       /* 0: not known */
    calibration_sensor sensor[MRT_ANGLES];
    char note[CALIBRATION_NOTE]; /* lines about what was read but not understood; "" none */
    void *document;              /* what was read, for the keys that are kept; owned; or NULL */
} calibration_file;

/* Empty: no sensor. What has no document needs no finish. */
void calibration_file_init(calibration_file *out, uint32_t side);
/* `name` is the file's, for messages: "NAME: $.sensors["index.mpj"].points[1]: expected ...".
 * On failure `out` needs no finish. */
CHECKED mrt_result calibration_file_parse(calibration_file *out, const void *bytes, size_t size,
                                          const char *name, error *err);
CHECKED mrt_result calibration_file_read(calibration_file *out, const char *path, error *err);
void calibration_file_finish(calibration_file *file); /* NULL and zeroed are fine */

/* The whole file, or what was there before. */
CHECKED mrt_result calibration_file_write(const calibration_file *file, const char *path,
                                          error *err);
/* The file's text, 0-ended, to be freed; NULL: no memory. */
char *calibration_file_text(const calibration_file *file);

uint32_t calibration_file_sensor_count(const calibration_file *file);
/* Sensors that the file lacks: of a glove the shipped defaults, of a bare hand as it says them. */
void calibration_file_use(const calibration_file *file, hand_calibration *out);

/* Appends a line; beyond the note's size nothing more. */
__attribute__((format(printf, 2, 3))) void calibration_file_note(calibration_file *file,
                                                                 const char *format, ...);

/* rad = gain * (raw - zero) + rad_at_zero, up to 15 degrees beyond the clinical range of the joint
 * (sensor.h), where the angle stays: the table's end slopes are 0. gain: not 0. */
hand_table calibration_line(int sensor, double gain, double zero, double rad_at_zero);

#endif
