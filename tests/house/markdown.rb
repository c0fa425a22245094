all
exclude_rule 'MD013' # long lines: tables have them
exclude_rule 'MD031' # a mark such as "<!-- not run: why -->" stands directly above its block
exclude_rule 'MD041' # templates of the forge begin without a title
rule 'MD026', punctuation: '.,;:!'
rule 'MD029', style: :ordered
