"""Ablation of the gap diagnosis: how many verdicts change when one rule is taken out.

    python -m benchmarks.ablation run raw.jsonl FOLDER [FOLDER ...]
    python -m benchmarks.ablation table raw.jsonl FOLDER [FOLDER ...] --note TEXT --write FILE
    python -m benchmarks.ablation again raw.jsonl FOLDER [FOLDER ...] --deleted RULE ... --write FILE

A folder holds drawn cases of ``python -m sim blind`` or of ``benchmarks.second_generator``, its key beside
the folder. Use cases whose key has been opened: the table chooses rules, and a sealed case must not.
"""
