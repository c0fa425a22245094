/* check/cases.h - what the cases are called, for the parent that starts them and the child that
 * runs them. */
#ifndef MAROTTE_CHECK_CASES_H
#define MAROTTE_CHECK_CASES_H

#define CASE_TABLES       "tables" /* of the library */
#define CASE_TYPE         "type"
#define CASE_QUICK        "quick" /* tables, type and smoke of every type */
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
#define CASE_ABSENT       "absent"
#define CASE_INPUT        "input"
#define CASE_RECORDED     "recorded"
#define CASE_STOP         "stop"
#define CASE_DEVICES      "devices"
#define CASE_OUTPUT       "output"

/* The child gives up by itself after WATCH_LIMIT_S of wall time, and can say where; the parent ends
 * it after CASE_LIMIT_S. */
enum { WATCH_LIMIT_S = 60, CASE_LIMIT_S = 75 };

#endif
