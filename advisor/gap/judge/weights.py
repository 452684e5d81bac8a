"""The weights of the judge, written by ``make judge``: do not edit them."""

from advisor.gap.judge.logit import Logit
from advisor.gap.judge.prior import FieldPrior

LOGIT = Logit(weights={}, intercepts={}, flown=FieldPrior(0.25, 0.25, 0.25, 0.25))
