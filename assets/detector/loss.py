"""What is learned: which places see an object (task-aligned assignment, Feng et al. 2021), its class,
its box (complete IoU, Zheng et al. 2020), and the distribution of its edges (Li et al. 2020)."""

import math

import torch
from torch.nn import functional as F

from network import BINS, anchors, boxes_of


def iou_of(a, b, complete=False):
    """IoU of corner boxes, elementwise; less what middles and proportions differ if `complete`."""
    low, high = torch.maximum(a[..., :2], b[..., :2]), torch.minimum(a[..., 2:], b[..., 2:])
    common = (high - low).clamp(min=0).prod(-1)
    size_a, size_b = (a[..., 2:] - a[..., :2]).clamp(min=0), (b[..., 2:] - b[..., :2]).clamp(min=0)
    iou = common / (size_a.prod(-1) + size_b.prod(-1) - common + 1e-7)
    if not complete:
        return iou
    hull = torch.maximum(a[..., 2:], b[..., 2:]) - torch.minimum(a[..., :2], b[..., :2])
    apart = ((a[..., :2] + a[..., 2:] - b[..., :2] - b[..., 2:]) ** 2).sum(-1) / 4
    shape = 4 / math.pi**2 * (
        torch.atan(size_a[..., 0] / (size_a[..., 1] + 1e-7)) - torch.atan(size_b[..., 0] / (size_b[..., 1] + 1e-7))
    ) ** 2
    with torch.no_grad():
        weight = shape / (shape - iou + 1 + 1e-7)
    return iou - apart / ((hull**2).sum(-1) + 1e-7) - weight * shape


class DetectionLoss:
    def __init__(self, classes, most=9, alpha=0.5, beta=6.0):
        self.classes, self.most, self.alpha, self.beta = classes, most, alpha, beta

    @torch.no_grad()
    def assign(self, scores, found, points, strides, truth):
        """Of one image: object of each place (−1: none) and how well it fits, 0–1."""
        places = points.shape[0]
        owner = torch.full((places,), -1, dtype=torch.long, device=points.device)
        quality = torch.zeros(places, device=points.device)
        if not len(truth):
            return owner, quality
        boxes = truth[:, 1:]
        # A small object has no cell's middle inside: it may take those within most of a cell.
        grown = boxes.clone()
        shortfall = (1.5 * strides.min() - (boxes[:, 2:] - boxes[:, :2])).clamp(min=0) / 2
        grown[:, :2] -= shortfall
        grown[:, 2:] += shortfall
        reach = torch.cat([points[None] - grown[:, None, :2], grown[:, None, 2:] - points[None]], -1).amin(-1)
        inside = reach > 0
        iou = iou_of(boxes[:, None], found[None], complete=True).clamp(min=0)
        fit = scores[:, truth[:, 0].long()].t().pow(self.alpha) * iou.pow(self.beta)
        fit = fit * inside
        best = fit.topk(min(self.most, places), 1)
        chosen = torch.zeros_like(inside)
        chosen.scatter_(1, best.indices, best.values > 1e-12)
        # An object that nothing fits yet takes the place next to its middle.
        nobody = ~chosen.any(1)
        if nobody.any():
            middle = (boxes[nobody, :2] + boxes[nobody, 2:]) / 2
            apart = ((points[None] - middle[:, None]) / strides[None, :, None]).norm(dim=-1) + strides[None] / 8
            chosen[nobody.nonzero()[:, 0], apart.argmin(1)] = True
        disputed = chosen.sum(0) > 1
        if disputed.any():
            winner = torch.where(chosen, iou, -1.0)[:, disputed].argmax(0)
            chosen[:, disputed] = False
            chosen[winner, disputed.nonzero()[:, 0]] = True
        taken = chosen.any(0)
        owner[taken] = chosen[:, taken].float().argmax(0)
        # The best place of an object is asked for the IoU that it reaches, others for less.
        fit, iou = fit * chosen, iou * chosen
        scaled = fit / (fit.amax(1, keepdim=True) + 1e-9) * iou.amax(1, keepdim=True)
        quality[taken] = scaled[:, taken].amax(0)
        return owner, quality

    def __call__(self, edges, names, truths, size):
        device = edges.device
        points, strides = anchors(*size, device=device)
        found = boxes_of(edges, points, strides)
        names = names.transpose(1, 2)
        asked = torch.zeros_like(names)
        weights, own, goal, rows = [], [], [], []
        for i, truth in enumerate(truths):
            truth = truth.to(device)
            owner, quality = self.assign(names[i].detach().sigmoid(), found[i].detach(), points, strides, truth)
            where = (owner >= 0).nonzero()[:, 0]
            if len(where):
                mine = truth[owner[where]]
                asked[i, where, mine[:, 0].long()] = quality[where]
                weights.append(quality[where])
                own.append(found[i, where])
                goal.append(mine[:, 1:])
                rows.append(torch.stack([torch.full_like(where, i), where], 1))
        total = asked.sum().clamp(min=1)
        class_loss = F.binary_cross_entropy_with_logits(names, asked, reduction="sum") / total
        if not own:
            return class_loss, [class_loss.item(), 0.0, 0.0]
        weights, own, goal, rows = torch.cat(weights), torch.cat(own), torch.cat(goal), torch.cat(rows)
        box_loss = ((1 - iou_of(own, goal, complete=True)) * weights).sum() / total
        p, s = points[rows[:, 1]], strides[rows[:, 1], None]
        distance = torch.cat([p - goal[:, :2], goal[:, 2:] - p], 1).div(s).clamp(0, BINS - 1.01)
        logits = edges.view(edges.shape[0], 4, BINS, -1)[rows[:, 0], :, :, rows[:, 1]]
        below = distance.floor()
        share = distance - below
        chances = logits.log_softmax(-1)
        pick = lambda at: chances.gather(-1, at.long()[..., None])[..., 0]
        edge_loss = -(pick(below) * (1 - share) + pick(below + 1) * share).mean(1)
        edge_loss = (edge_loss * weights).sum() / total
        loss = 0.5 * class_loss + 7.5 * box_loss + 1.5 * edge_loss
        return loss, [part.item() for part in (class_loss, box_loss, edge_loss)]
