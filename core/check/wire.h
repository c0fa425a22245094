/* check/wire.h - protocol between the parent that starts cases and the child that runs them: the
 * names of the cases, and the findings as lines "KIND NAME TEXT\n" on descriptor WIRE_FD, in
 * printable bytes. The name contains no blank. */
#ifndef MAROTTE_CHECK_WIRE_H
#define MAROTTE_CHECK_WIRE_H

/* ---- cases ---- */

#define CASE_TABLES       "tables" /* of the library */
#define CASE_TYPE         "type"
#define CASE_QUICK        "quick" /* tables, type and smoke test of all types */
#define CASE_SMOKE        "smoke"
#define CASE_LIFE         "life"
#define CASE_DESTROY_NULL "destroy_null"
#define CASE_FACES        "faces"
#define CASE_GROWTH       "growth"
#define CASE_WALK         "walk"
#define CASE_RESTLESS     "restless"
#define CASE_HANDS        "hands"
#define CASE_ENGAGE       "engage"
#define CASE_DEADLINE     "deadline"
#define CASE_REPLAY       "replay"
#define CASE_SUM          "sum"
#define CASE_STATE        "state"
#define CASE_RESUME       "resume"
#define CASE_RIG_POSES    "rig_poses"
#define CASE_ABSENT       "absent"
#define CASE_INPUT        "input"
#define CASE_RECORDED     "recorded"
#define CASE_STOP         "stop"
#define CASE_DEVICES      "devices"
#define CASE_OUTPUT       "output"
#define CASE_FACE_OUTPUT  "face_output"

/* The child ends itself after WATCH_LIMIT_S of wall time, and reports the place. The parent kills
 * it after CASE_LIMIT_S. */
enum { WATCH_LIMIT_S = 60, CASE_LIMIT_S = 75 };

/* ---- lines ---- */

enum { WIRE_FD = 3, WIRE_TEXT = 960, WIRE_LINE = 1024 };
enum {
    WIRE_OK = 'O',      /* NAME: a rule */
    WIRE_FAILED = 'F',  /* a rule */
    WIRE_SKIPPED = 'S', /* a rule */
    WIRE_FACT = 'I',    /* a name known to parent and case */
    WIRE_END = 'E'      /* the case reached its end */
};

/* ---- the names of facts ---- */

/* "INDEX CONCERNS ID": a type of the library. */
#define WIRE_TYPE "type"
/* A checksum of all pulls of a take: the same in every process. */
#define WIRE_SUM "sum"

#endif
