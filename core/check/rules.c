#include "check/rules.h"

#include <string.h>

typedef struct rule_facts {
    const char *id, *says;
    uint32_t concerns;
} rule_facts;

static const rule_facts table[RULE_COUNT] = {
#define RULE_FACTS(name, id, concerns, says) {id, says, concerns},
    CHECK_RULES(RULE_FACTS)
#undef RULE_FACTS
};

const char *check_rule_id(check_rule rule)
{
    return table[rule].id;
}

const char *check_rule_text(check_rule rule)
{
    return table[rule].says;
}

uint32_t check_rule_concerns(check_rule rule)
{
    return table[rule].concerns;
}

bool check_rule_find(const char *id, check_rule *out)
{
    for (int i = 0; i < RULE_COUNT; ++i) {
        if (strcmp(table[i].id, id) != 0)
            continue;
        *out = (check_rule)i;
        return true;
    }
    return false;
}
